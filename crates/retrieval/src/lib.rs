//! Rankings, scores and votes: how well distances bring together what belongs together.
//!
//! `linalg::DistanceMatrix` -> **[`evaluate`]** -> scores
//!
//! Works on matrices, distances and labels alone: knows nothing of meshes, of how a distance was measured or of
//! files.

mod classification;
mod clustering;
mod curves;
mod error;
mod evaluation;
mod labels;
mod pairwise;
mod ranking;
mod refinement;
mod vote;

pub use classification::{confusion_matrix, knn_predict};
pub use clustering::silhouette;
pub use curves::{Averaging, MeanScores, mean_scores, precision_recall};
pub use error::RetrievalError;
pub use evaluation::{Evaluation, evaluate};
pub use labels::Labels;
pub use pairwise::pairwise_distances;
pub use ranking::{QueryScores, Ranking, rank};
pub use refinement::{Candidate, Neighbor, Refinement, refine_nearest};
pub use vote::{UnknownThreshold, Vote, vote};
