//! Collections of meshes as an index: building, changing, searching and scoring it.
//!
//! ```text
//! files -> content hash -> unchanged? -> describe -> index::IndexWriter -> index::Index
//! Query -> bounds (robust distances of all vectors) -> rerank (aligned forms) -> vote
//!                  -> Index::nearest_on_graph -> aligned forms of the results -> vote
//! PackedQuery -> ShapeSearch::shortlist and match_shapes of every shard -> merge_matches -> vote
//! mesh -> describe_part -> disc areas of all shapes -> aligned forms of the results -> vote
//! ```

mod build;
mod change;
mod components;
mod distances;
mod duplicates;
mod evaluate;
mod explain;
mod export;
mod found;
mod moves;
mod options;
mod place;
mod predict;
mod query;
mod record;
mod rerank;
mod resolve;
mod search;
mod shards;
mod source;

pub use build::{
    BuildOptions, BuildReport, Dropped, Elsewhere, Failure, FailureReason, build_index, indexed_shapes,
    unchanged_index,
};
pub use change::{MergeReport, add_to_index, merge_indexes, remove_from_index};
pub use distances::PairwiseDistance;
pub use duplicates::{
    DuplicateFile, DuplicateGroup, DuplicateMember, DuplicateOptions, DuplicateReport, find_duplicates,
};
pub use evaluate::{EvaluateOptions, Measure, evaluate_index, evaluate_matrix};
pub use export::export_index;
pub use found::{ComponentResult, OrderedBy, SearchResult, ShardMatch};
pub use moves::{MoveReport, NotMoved, check_place, move_duplicates, undo_moves};
pub use options::{Explain, SearchOptions, SearchRank};
pub use place::mesh_path;
pub use predict::{ClassVotes, NearestShape, Prediction, Unknown};
pub use query::{DescribedQuery, Query};
pub use rerank::{Ranked, Reranked, bounds, rerank};
pub use search::{SearchReport, SearchSeconds, ShapeSearch, ShardedSearch};
pub use shards::{PackedQuery, ShardExplained, ShardMatches, merge_matches};
pub use source::{Inputs, ShapeLimits, Shard};
