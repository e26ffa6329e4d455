//! Collections of meshes as an index: building, changing, searching and scoring it.
//!
//! ```text
//! files -> content hash -> unchanged? -> describe -> Shape -> index::IndexWriter -> index::Index
//! mesh -> describe -> Query -> bounds (robust distances of all vectors) -> rerank (aligned forms) -> vote -> Answer
//!                           -> neighbour graph | disc areas | spectra of all shapes -> aligned forms of the results
//! Query -> an Answer of every shard -> merge_answers -> Answer
//! ```

mod agreement;
mod ask;
mod build;
mod change;
mod components;
mod distances;
mod duplicates;
mod evaluate;
mod explain;
mod export;
mod found;
mod merge;
mod moves;
mod options;
mod place;
mod predict;
mod query;
mod record;
mod rerank;
mod search;
mod source;

pub use agreement::Agreement;
pub use build::{
    BuildOptions, BuildReport, Dropped, Failure, FailureReason, build_index, indexed_shapes, unchanged_index,
};
pub use change::{MergeReport, add_to_index, merge_indexes, remove_from_index};
pub use distances::PairwiseDistance;
pub use duplicates::{
    DuplicateFile, DuplicateGroup, DuplicateMember, DuplicateOptions, DuplicateReport, Keep, find_duplicates,
};
pub use evaluate::{EvaluateOptions, IndexEvaluation, Measure, evaluate_index, evaluate_matrix};
pub use export::export_index;
pub use found::{ComponentResult, Hit, OrderedBy};
pub use merge::{merge_answers, n_candidates};
pub use moves::{MoveReport, NotMoved, check_place, move_duplicates, undo_moves};
pub use options::{SearchOptions, SearchRank};
pub use place::mesh_path;
pub use predict::{ClassVotes, NearestShape, Prediction, Unknown, n_results};
pub use query::Query;
pub use rerank::{Aligned, bounds, rerank};
pub use search::{Answer, SearchSeconds, ShapeSearch};
pub use source::{Inputs, ShapeLimits, Shard};
