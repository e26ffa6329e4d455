//! Classification by the votes of neighbours.

use linalg::DistanceMatrix;

use crate::{Labels, RetrievalError, rank};

/// The class that most of the `k` nearest other shapes belong to; the nearest neighbour's among
/// equally popular ones.
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
    if k == 0 || available == 0 {
        return Err(RetrievalError::BadNeighborCount { k, available });
    }
    let neighbours = rank(distances, query).order;
    let mut votes = vec![0usize; labels.classes().len()];
    neighbours.iter().take(k).for_each(|&i| votes[labels.class(i)] += 1);
    let most = votes.iter().copied().max().unwrap_or(0);
    let winner = neighbours.iter().map(|&i| labels.class(i)).find(|&class| votes[class] == most);
    Ok(winner.unwrap_or(0))
}

/// `matrix[true class][predicted class]`: every shape of a class with more than two members is
/// classified by the `k` nearest of all others.
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
    fn the_majority_wins_and_the_nearest_breaks_a_draw() {
        let places = [0.0f64, 1.0, 2.0, 3.0];
        let distances = DistanceMatrix::from_pairs(4, |i, j| (places[i] - places[j]).abs()).unwrap();
        let labels = Labels::new(&["a", "a", "b", "b"]);
        assert_eq!(knn_predict(&distances, &labels, 0, 1), Ok(0));
        assert_eq!(knn_predict(&distances, &labels, 0, 2), Ok(0), "one vote each, a is nearer");
        assert_eq!(knn_predict(&distances, &labels, 0, 3), Ok(1));
        assert_eq!(
            knn_predict(&distances, &labels, 0, 0),
            Err(RetrievalError::BadNeighborCount { k: 0, available: 3 })
        );
    }
}
