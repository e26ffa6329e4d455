//! Points prepared to be aligned with many others.

use nalgebra::{Matrix3, Point3};

use crate::farthest_points::farthest_points;
use crate::nearest::{NearestPoints, NoExtent};
use crate::similarity::Similarity;

/// Points in their principal axes, with evenly spread samples and search trees.
#[derive(Debug)]
pub struct PointSet {
    points: NearestPoints,
    samples: NearestPoints,
    /// Standard deviation along each principal axis, descending.
    pub(crate) axis_std: [f64; 3],
    /// The motion from the coordinates of the points to their principal axes.
    pub(crate) to_principal: Similarity,
}

impl PointSet {
    /// Samples of every set that are aligned with the nearest points of another one.
    pub const SAMPLES: usize = 400;

    /// Turns points into their weighted principal axes about the origin and spreads [`SAMPLES`](Self::SAMPLES) of them evenly
    /// by farthest point sampling; fewer if there are no more. Weights sum to one.
    ///
    /// # Errors
    /// [`NoExtent`].
    pub fn new(points: &[Point3<f64>], weights: &[f64]) -> Result<Self, NoExtent> {
        let (axes, axis_std) = principal_axes(points, weights);
        let to_principal = Similarity::about_origin(axes);
        let points: Vec<_> = points.iter().map(|p| to_principal.apply(p)).collect();
        let spread = farthest_points(&points, Self::SAMPLES);
        let samples: Vec<_> = spread.samples.iter().map(|&i| points[i]).collect();
        Ok(Self {
            points: NearestPoints::new(points)?,
            samples: NearestPoints::new(samples)?,
            axis_std,
            to_principal,
        })
    }

    /// All points, in the principal axes.
    pub fn points(&self) -> &[Point3<f64>] {
        self.points.points()
    }

    /// All points, to be searched.
    pub(crate) fn all(&self) -> &NearestPoints {
        &self.points
    }

    /// Evenly spread points, farthest first: any leading part of them is evenly spread too.
    pub(crate) fn samples(&self) -> &NearestPoints {
        &self.samples
    }
}

/// The rotation into principal axes, with the directions of largest, second largest and smallest deviation as rows, and the
/// standard deviation along each, a length. The signs of axes, and the order of axes with equal deviations, are arbitrary.
fn principal_axes(points: &[Point3<f64>], weights: &[f64]) -> (Matrix3<f64>, [f64; 3]) {
    let mut covariance = Matrix3::zeros();
    for (p, w) in points.iter().zip(weights) {
        covariance += p.coords * p.coords.transpose() * *w;
    }
    let eigen = covariance.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| eigen.eigenvalues[j].total_cmp(&eigen.eigenvalues[i]));
    let axes = Matrix3::from_columns(&order.map(|i| eigen.eigenvectors.column(i).into_owned()));
    (axes.transpose(), order.map(|i| eigen.eigenvalues[i].max(0.0).sqrt()))
}
