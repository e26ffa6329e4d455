//! Ranked lists.

use linalg::DistanceMatrix;

/// A shape and its distance from a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Neighbor {
    /// Index of the shape.
    pub index: usize,
    /// Its distance from the query.
    pub distance: f64,
}

impl Neighbor {
    /// Orders by distance, ties by index.
    pub fn by_distance(&self, other: &Self) -> std::cmp::Ordering {
        self.distance.total_cmp(&other.distance).then(self.index.cmp(&other.index))
    }
}

/// The ranking of all other shapes for every shape of a collection.
///
/// Scores need only this. A [`DistanceMatrix`] ranks by distance, [`GraphRankings`](crate::GraphRankings) on the
/// neighbor graph.
pub trait Rankings: Sync {
    /// Number of shapes.
    fn n_points(&self) -> usize;

    /// All shapes except `query`, nearest first by what these rankings order by.
    fn ranking(&self, query: usize) -> Vec<Neighbor>;
}

impl Rankings for DistanceMatrix {
    fn n_points(&self) -> usize {
        self.n_points()
    }

    fn ranking(&self, query: usize) -> Vec<Neighbor> {
        rank(self, query)
    }
}

/// All shapes except `query`, nearest first; ties by index.
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::DistanceMatrix;
///
/// let positions = [0.0_f64, 5.0, -2.0, 2.0];
/// let distances = DistanceMatrix::from_pairs(4, |i, j| (positions[i] - positions[j]).abs())?;
/// let order: Vec<usize> = canonform_retrieval::rank(&distances, 0).iter().map(|n| n.index).collect();
/// assert_eq!(order, [2, 3, 1]);
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
pub fn rank(distances: &DistanceMatrix, query: usize) -> Vec<Neighbor> {
    rank_row(distances.row(query), query)
}

/// The same from the distances of `query` to all shapes.
pub fn rank_row(distances: &[f64], query: usize) -> Vec<Neighbor> {
    let others = distances.iter().enumerate().filter(|(index, _)| *index != query);
    let mut neighbors: Vec<_> = others.map(|(index, &distance)| Neighbor { index, distance }).collect();
    neighbors.sort_by(Neighbor::by_distance);
    neighbors
}
