//! Retrieval from distances: rankings, scores, votes, and search with an expensive distance.
//!
//! `linalg::DistanceMatrix` -> [`Rankings`] by distance or on the [neighbor graph](graph_rank) -> **[`evaluate`]** ->
//! [`Evaluation`]
//!
//! Works on distances and labels alone; it knows nothing of meshes, files, or how distances were measured.
//!
//! ```
//! # extern crate linalg as canonform_linalg;
//! use canonform_linalg::DistanceMatrix;
//! use canonform_retrieval::{Labels, RankBy, evaluate};
//!
//! let positions = [0.0_f64, 1.0, 2.0, 10.0, 11.0, 12.0];
//! let distances = DistanceMatrix::from_pairs(6, |i, j| (positions[i] - positions[j]).abs())?;
//! let labels = Labels::new(&["cat", "cat", "cat", "dog", "dog", "dog"]);
//! let evaluation = evaluate(&distances, &labels, 1, RankBy::Plain)?;
//! assert_eq!(evaluation.plain.mean.map, 1.0);
//! assert_eq!(evaluation.plain.confusion, [[3, 0], [0, 3]]);
//! # Ok::<(), canonform_retrieval::RetrievalError>(())
//! ```

mod bootstrap;
mod clustering;
mod error;
mod evaluation;
mod graph;
mod labels;
mod ranking;
mod refinement;
mod scores;
mod vote;

pub use bootstrap::{ScoreIntervals, bootstrap};
pub use clustering::silhouette;
pub use error::RetrievalError;
pub use evaluation::{Evaluation, RankBy, RankingEvaluation, evaluate};
pub use graph::{GraphNeighbor, GraphRankings, LINKS, graph_rank};
pub use labels::Labels;
pub use ranking::{Neighbor, Rankings, rank, rank_row};
pub use refinement::{Refinement, refine_nearest};
pub use scores::{QueryScores, Scores, precision_recall};
pub use vote::{Tally, Vote, vote};
