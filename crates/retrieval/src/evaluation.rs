//! The record of how well a distance matrix separates labelled shapes.

use linalg::DistanceMatrix;
use serde::{Deserialize, Serialize};

use crate::{Labels, QueryScores, RetrievalError, confusion_matrix, rank, silhouette};

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

/// Scores a labelled distance matrix.
///
/// Every shape is a query against all others, itself excluded, ties by index; classes of one or two
/// shapes are ranked but not queried. Scores are means over queries (micro averages).
///
/// # Errors
/// [`RetrievalError::LabelCount`], [`RetrievalError::NothingToScore`],
/// [`RetrievalError::BadNeighborCount`].
pub fn evaluate(
    distances: &DistanceMatrix,
    labels: &Labels,
    knn_k: usize,
) -> Result<Evaluation, RetrievalError> {
    let n = distances.n_points();
    if labels.n_points() != n {
        return Err(RetrievalError::LabelCount { n_labels: labels.n_points(), n_points: n });
    }
    let scores: Vec<QueryScores> = (0..n)
        .filter(|&query| labels.is_query(query))
        .filter_map(|query| QueryScores::new(&rank(distances, query), query, labels))
        .collect();
    if scores.is_empty() {
        return Err(RetrievalError::NothingToScore { n_points: n, n_classes: labels.classes().len() });
    }
    let mean = |score: fn(&QueryScores) -> f64| scores.iter().map(score).sum::<f64>() / scores.len() as f64;
    let confusion = confusion_matrix(distances, labels, knn_k)?;
    let right: usize = confusion.iter().enumerate().map(|(class, row)| row[class]).sum();
    Ok(Evaluation {
        n,
        classes: labels.classes().to_vec(),
        nn: mean(|s| s.nearest_neighbor),
        ft: mean(|s| s.first_tier),
        st: mean(|s| s.second_tier),
        e: mean(|s| s.e_measure),
        dcg: mean(|s| s.dcg),
        map: mean(|s| s.average_precision),
        knn_accuracy: right as f64 / scores.len() as f64,
        knn_k,
        confusion,
        silhouette: silhouette(distances, labels),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn two_clusters(gap: f64) -> (DistanceMatrix, Labels) {
        let place = |i: usize| if i < 4 { i as f64 } else { gap + i as f64 };
        let matrix = DistanceMatrix::from_pairs(9, |i, j| (place(i) - place(j)).abs()).unwrap();
        let names: Vec<&str> = (0..9).map(|i| ["a", "b"][usize::from(i >= 4)]).collect();
        (matrix, Labels::new(&names))
    }

    #[test]
    fn separate_clusters_score_one() {
        let (matrix, labels) = two_clusters(100.0);
        let scores = evaluate(&matrix, &labels, 3).unwrap();
        assert_eq!([scores.nn, scores.ft, scores.st, scores.map, scores.knn_accuracy], [1.0; 5]);
        assert!((scores.dcg - 1.0).abs() < 1e-15 && scores.silhouette > 0.95);
        assert_eq!(scores.confusion, [[4, 0], [0, 5]]);
    }

    #[test]
    fn scaling_the_distances_changes_nothing() {
        let (matrix, labels) = two_clusters(0.5);
        let scaled = DistanceMatrix::from_pairs(9, |i, j| 7.0 * matrix.get(i, j)).unwrap();
        let (a, b) = (evaluate(&matrix, &labels, 1).unwrap(), evaluate(&scaled, &labels, 1).unwrap());
        assert!((a.silhouette - b.silhouette).abs() < 1e-12);
        assert_eq!(Evaluation { silhouette: 0.0, ..a }, Evaluation { silhouette: 0.0, ..b });
    }

    #[test]
    fn classes_of_two_are_not_queried() {
        let matrix = DistanceMatrix::from_pairs(5, |i, j| (j - i) as f64).unwrap();
        let scores = evaluate(&matrix, &Labels::new(&["a", "a", "a", "b", "b"]), 1).unwrap();
        assert_eq!(scores.confusion, [[3, 0], [0, 0]]);
        assert_eq!(
            evaluate(&matrix, &Labels::new(&["a", "a", "b", "b", "c"]), 1),
            Err(RetrievalError::NothingToScore { n_points: 5, n_classes: 3 })
        );
        assert_eq!(
            evaluate(&matrix, &Labels::new(&["a"]), 1),
            Err(RetrievalError::LabelCount { n_labels: 1, n_points: 5 })
        );
    }
}
