//! Nearest points.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Point3;

/// A search tree.
pub(super) struct Neighbors {
    tree: Option<ImmutableKdTree<f64, 3>>,
    n_points: usize,
}

impl Neighbors {
    pub(super) fn new(points: &[Point3<f64>]) -> Self {
        let coordinates: Vec<[f64; 3]> = points.iter().map(|p| p.coords.into()).collect();
        Self { tree: ImmutableKdTree::new_from_slice(&coordinates).ok(), n_points: points.len() }
    }

    /// The `k` points nearest to a place, or all if there are fewer, and the squares of their distances, ascending. Of points at
    /// the same distance the one with the lower number comes first.
    pub(super) fn nearest(&self, place: &Point3<f64>, k: usize) -> Vec<(u32, f64)> {
        let (Some(tree), Some(k)) = (&self.tree, NonZero::new(k.min(self.n_points))) else {
            return Vec::new();
        };
        let place: [f64; 3] = place.coords.into();
        let hits = tree.query(&place).nearest_n::<SquaredEuclidean<f64>>(k).execute();
        let mut found: Vec<(u32, f64)> = hits.iter().map(|hit| (hit.item, hit.distance)).collect();
        found.sort_unstable_by(|a, b| a.1.total_cmp(&b.1).then(a.0.cmp(&b.0)));
        found
    }
}
