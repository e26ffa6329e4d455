//! The record of how well a distance matrix separates labelled shapes.

use serde::{Deserialize, Serialize};

/// Retrieval, classification and clustering scores of one labelled distance matrix.
///
/// All scores lie in 0..=1 (the silhouette in -1..=1) and are means over the queries whose class
/// has more than two members. Conventions: [`evaluate`](crate::evaluate).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Evaluation {
    /// Number of shapes.
    pub n: usize,
    /// Class names, sorted; rows and columns of `confusion`.
    pub classes: Vec<String>,
    /// Share of queries whose nearest neighbour is of their class.
    pub nn: f64,
    /// First tier.
    pub ft: f64,
    /// Second tier.
    pub st: f64,
    /// E-measure at rank min(32, n - 1).
    pub e: f64,
    /// Normalised discounted cumulative gain.
    pub dcg: f64,
    /// Mean average precision.
    pub map: f64,
    /// Leave-one-out k-nearest-neighbour accuracy.
    pub knn_accuracy: f64,
    /// The k of `knn_accuracy` and `confusion`.
    pub knn_k: usize,
    /// `confusion[true class][predicted class]`, counts of the leave-one-out k-NN vote.
    pub confusion: Vec<Vec<usize>>,
    /// Mean silhouette of the classes.
    pub silhouette: f64,
}
