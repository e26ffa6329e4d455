//! Nearest points.

use std::num::NonZero;

use kiddo::{ImmutableKdTree, SquaredEuclidean};
use nalgebra::Point3;

/// Points that cannot be searched or aligned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("all {n_points} points coincide or are not finite")]
pub struct NoExtent {
    /// Number of points.
    pub n_points: usize,
}

/// Points with a search tree.
pub struct NearestPoints {
    points: Vec<Point3<f64>>,
    tree: ImmutableKdTree<f64, 3>,
}

impl std::fmt::Debug for NearestPoints {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("NearestPoints").field("n_points", &self.points.len()).finish_non_exhaustive()
    }
}

impl NearestPoints {
    /// # Errors
    /// [`NoExtent`] if there are no points or a coordinate is not finite.
    pub fn new(points: Vec<Point3<f64>>) -> Result<Self, NoExtent> {
        let coordinates: Vec<[f64; 3]> = points.iter().map(|p| p.coords.into()).collect();
        let tree =
            ImmutableKdTree::new_from_slice(&coordinates).map_err(|_| NoExtent { n_points: points.len() })?;
        Ok(Self { points, tree })
    }

    /// All points.
    pub fn points(&self) -> &[Point3<f64>] {
        &self.points
    }

    /// The index of the point nearest to `query`, and its squared distance.
    #[inline]
    pub fn nearest(&self, query: &Point3<f64>) -> (usize, f64) {
        let query: [f64; 3] = query.coords.into();
        let hit = self.tree.query(&query).nearest_one::<SquaredEuclidean<f64>>().execute();
        (hit.item as usize, hit.distance)
    }

    /// The indices of up to `most` points within a distance of `query`, the nearest first.
    pub fn near(&self, query: &Point3<f64>, distance: f64, most: NonZero<usize>) -> Vec<usize> {
        let query: [f64; 3] = query.coords.into();
        let hits =
            self.tree.query(&query).nearest_n::<SquaredEuclidean<f64>>(most).within(distance * distance);
        hits.execute().iter().map(|hit| hit.item as usize).collect()
    }
}
