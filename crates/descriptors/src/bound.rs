//! A lower bound of the distance between two forms over all alignments.

use nalgebra::Point3;

/// The extent of a form, which bounds its distance to other forms.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Extent {
    /// No two points of the form are farther apart.
    diameter: f64,
    /// Distances between disjoint pairs of samples far from each other, descending.
    spans: Vec<f64>,
    n_samples: usize,
}

impl Extent {
    /// The extent from samples; no point of the form is farther than `covering` from the nearest one.
    pub(crate) fn new(samples: &[Point3<f64>], covering: f64) -> Self {
        let n_samples = samples.len();
        let mut diameter = 0.0f64;
        let mut spans = Vec::with_capacity(n_samples / 2);
        let mut free = vec![true; n_samples];
        for i in 0..n_samples {
            let mut farthest = (0.0, i);
            for j in 0..n_samples {
                let length = (samples[i] - samples[j]).norm();
                diameter = diameter.max(length);
                if free[j] && length > farthest.0 {
                    farthest = (length, j);
                }
            }
            if free[i] && farthest.1 != i {
                free[i] = false;
                free[farthest.1] = false;
                spans.push(farthest.0);
            }
        }
        spans.sort_by(|a, b| b.total_cmp(a));
        Self { diameter: diameter + 2.0 * covering, spans, n_samples }
    }

    /// A lower bound of the root mean square distance between nearest points of two forms, over all motions.
    ///
    /// Let samples `x, x'` of one form have the nearest points `y, y'` of the other, at distances `e, e'`. Then
    /// `e + e' >= |x - x'| - |y - y'| >= |x - x'| - diameter`, so `e² + e'² >= (|x - x'| - diameter)² / 2` if the
    /// difference is positive. Summing over disjoint pairs of samples bounds the sum of all squares.
    pub(crate) fn least_distance(&self, other: &Self) -> f64 {
        (0.5 * (self.beyond(other.diameter) + other.beyond(self.diameter))).sqrt()
    }

    fn beyond(&self, diameter: f64) -> f64 {
        let sq = self.spans.iter().take_while(|span| **span > diameter).map(|span| (span - diameter).powi(2));
        0.5 * sq.sum::<f64>() / self.n_samples.max(1) as f64
    }
}
