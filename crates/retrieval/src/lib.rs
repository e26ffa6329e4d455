//! Shapes that are kept and found again, and how well distances bring together what belongs together.
//!
//! `linalg::DistanceMatrix` -> **[`evaluate`]** -> scores
//!
//! vectors of shapes -> **[`IndexWriter`] -> [`Index`] -> [`Searcher`]** -> nearest shapes
//!
//! Works on matrices, vectors and labels alone: knows nothing of meshes, of how a distance was measured
//! or a vector was made.

mod classification;
mod clustering;
mod curves;
mod error;
mod evaluation;
mod index;
mod labels;
mod pairwise;
mod ranking;
mod refinement;
mod search;
mod vote;

pub use classification::{confusion_matrix, knn_predict};
pub use clustering::silhouette;
pub use curves::{Averaging, MeanScores, mean_scores, precision_recall};
pub use error::RetrievalError;
pub use evaluation::{Evaluation, evaluate};
pub use index::{
    CodecError, ContentHash, ExportError, FORMAT_VERSION, Index, IndexError, IndexWriter, Job, Shape,
    ShapeEntry, ShapeVectors, Verification, verify, work_path,
};
pub use labels::Labels;
pub use pairwise::pairwise_distances;
pub use ranking::{QueryScores, Ranking, rank};
pub use refinement::{Candidate, Neighbor, Refinement, refine_nearest};
pub use search::{Found, NearShape, SearchMode, Searcher};
pub use vote::{UnknownThreshold, Vote, vote};
