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
    /// No two points are farther apart.
    diameter: f64,
    /// Distances between disjoint pairs of samples far from each other, descending.
    spans: Vec<f64>,
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
        let (sq_diameter, spans) = extent(&samples);
        Ok(Self {
            diameter: sq_diameter.sqrt() + 2.0 * spread.covering,
            spans,
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

    /// A lower bound of the root mean square distance between nearest points of two sets, over all motions.
    ///
    /// Let samples `x, x'` of one set have the nearest points `y, y'` of the other, at distances `e, e'`. Then
    /// `e + e' >= |x - x'| - |y - y'| >= |x - x'| - diameter`, so `e² + e'² >= (|x - x'| - diameter)² / 2` if the
    /// difference is positive. Summing over disjoint pairs of samples bounds the sum of all squares.
    pub fn least_distance(&self, other: &Self) -> f64 {
        (0.5 * (self.beyond(other.diameter) + other.beyond(self.diameter))).sqrt()
    }

    fn beyond(&self, diameter: f64) -> f64 {
        let sq = self.spans.iter().take_while(|span| **span > diameter).map(|span| (span - diameter).powi(2));
        0.5 * sq.sum::<f64>() / self.samples.points().len().max(1) as f64
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

/// The largest squared distance between samples, and the distances between disjoint pairs of them, descending.
fn extent(samples: &[Point3<f64>]) -> (f64, Vec<f64>) {
    let mut sq_diameter = 0.0f64;
    let mut spans = Vec::with_capacity(samples.len() / 2);
    let mut free = vec![true; samples.len()];
    for i in 0..samples.len() {
        let mut farthest = (0.0, i);
        // Those before are paired already.
        for j in i + 1..samples.len() {
            let sq_length = (samples[i] - samples[j]).norm_squared();
            sq_diameter = sq_diameter.max(sq_length);
            if sq_length > farthest.0 && free[j] {
                farthest = (sq_length, j);
            }
        }
        if free[i] && farthest.1 != i {
            free[farthest.1] = false;
            spans.push(farthest.0.sqrt());
        }
    }
    spans.sort_by(|a, b| b.total_cmp(a));
    (sq_diameter, spans)
}
