//! Classification by k nearest neighbours.

use linalg::DistanceMatrix;

use crate::{Labels, RetrievalError, rank, vote};

/// The most frequent class among the `k` nearest other shapes; ties go to the class of the nearest of them.
///
/// # Errors
/// [`RetrievalError::BadNeighborCount`].
pub fn knn_predict(
    distances: &DistanceMatrix,
    labels: &Labels,
    query: usize,
    k: usize,
) -> Result<usize, RetrievalError> {
    let available = distances.n_points() - 1;
    let winner = vote(&rank(distances, query), |i| labels.class(i), k, None).class;
    winner.ok_or(RetrievalError::BadNeighborCount { k, available })
}

/// `matrix[true class][predicted class]`: classifies each shape whose class has more than two members by the `k`
/// nearest of all others.
///
/// # Errors
/// [`RetrievalError::BadNeighborCount`].
pub fn confusion_matrix(
    distances: &DistanceMatrix,
    labels: &Labels,
    k: usize,
) -> Result<Vec<Vec<usize>>, RetrievalError> {
    let n_classes = labels.classes().len();
    let mut matrix = vec![vec![0; n_classes]; n_classes];
    for i in (0..labels.n_points()).filter(|&i| labels.is_query(i)) {
        matrix[labels.class(i)][knn_predict(distances, labels, i, k)?] += 1;
    }
    Ok(matrix)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_majority_wins_and_the_nearest_breaks_a_tie() {
        let positions = [0.0f64, 1.0, 2.0, 3.0];
        let distances = DistanceMatrix::from_pairs(4, |i, j| (positions[i] - positions[j]).abs()).unwrap();
        let labels = Labels::new(&["a", "a", "b", "b"]);
        assert_eq!(knn_predict(&distances, &labels, 0, 1), Ok(0));
        assert_eq!(knn_predict(&distances, &labels, 0, 2), Ok(0), "one vote each, and a is nearer");
        assert_eq!(knn_predict(&distances, &labels, 0, 3), Ok(1));
        assert_eq!(
            knn_predict(&distances, &labels, 0, 0),
            Err(RetrievalError::BadNeighborCount { k: 0, available: 3 })
        );
    }
}
