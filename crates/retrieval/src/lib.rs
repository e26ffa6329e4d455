//! How well distances bring together what belongs together.
//!
//! `linalg::DistanceMatrix` -> **[`evaluate`]** -> scores
//!
//! Works on matrices and labels alone: knows nothing of meshes or of how a distance was made.

mod classification;
mod clustering;
mod error;
mod evaluation;
mod labels;
mod pairwise;
mod ranking;

pub use classification::{confusion_matrix, knn_predict};
pub use clustering::silhouette;
pub use error::RetrievalError;
pub use evaluation::{Evaluation, evaluate};
pub use labels::Labels;
pub use pairwise::pairwise_distances;
pub use ranking::{QueryScores, Ranking, rank};
