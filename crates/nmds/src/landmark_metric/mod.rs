//! All pairs of distances from a few columns, in a few hundred bytes per point.
//!
//! `bounds` (what the triangle inequality says about a pair), `factors` (the Nystrom approximation of all squared
//! distances), and here the estimate that they make together.

mod bounds;
mod factors;

use linalg::LandmarkDistances;

pub use bounds::{BoundsParts, ColumnError, Interval, LandmarkBounds};
pub use factors::{FactorParts, SqDistanceFactors};

use crate::NmdsError;

/// What the distances to n landmarks say about the distance of any two of p points: an interval that holds it, and an
/// estimate in the interval.
///
/// * **Interval** ([`LandmarkBounds`]): `max |F_xi - F_yi| <= d(x, y) <= min (F_xi + F_yi)` over the landmarks i, widened by
///   the rounding of the stored columns and by their [`ColumnError`].
/// * **Estimate** ([`SqDistanceFactors`]): the Nystrom approximation of the squared distances, limited to the interval. The
///   approximation of `d(x, x)² = 0` is not zero. Half the sum of its values at `(x, x)` and `(y, y)` is subtracted where
///   x and y are near each other, compared with their distances to the landmarks next to them.
/// * Symmetric, and zero for equal points.
/// * Memory: `2 n + 2 rank + 4` bytes per point. Cost: `O(n + rank)` for a pair, which reads two short rows.
///
/// The approximation is that of the Nystrom method (`shamai2015` in `REFERENCES.bib`). The interval is that of landmark
/// searches on graphs (Goldberg and Harrelson 2005, `goldberg2005`).
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::{LandmarkDistances, Matrix};
/// use canonform_nmds::{ColumnError, LandmarkMetric};
///
/// // 100 points on a circle of length 100, and exact distances from ten of them.
/// let along = |i: usize, j: usize| (i.abs_diff(j) as f64).min(100.0 - i.abs_diff(j) as f64);
/// let landmarks: Vec<usize> = (0..10).map(|j| 10 * j).collect();
/// let columns = Matrix::from_fn(100, 10, |i, j| along(i, landmarks[j]));
/// let distances = LandmarkDistances::new(landmarks, columns)?;
///
/// let metric = LandmarkMetric::new(&distances, 10, ColumnError::NONE, 6)?;
/// let pair = metric.pair(3, 48);
/// assert!(pair.bounds.contains(45.0) && pair.bounds.contains(pair.distance));
/// assert!((pair.distance - 45.0).abs() < 0.5);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkMetric {
    bounds: LandmarkBounds,
    factors: SqDistanceFactors,
    /// For every point, the distance to the nearest landmark and the approximation of its squared distance from itself, in
    /// the quanta of the bounds and the squared quanta of the factors.
    local: Vec<[f32; 2]>,
}

/// What is known about the distance of two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PairEstimate {
    /// The estimate, in `bounds`.
    pub distance: f64,
    /// The interval that holds the distance.
    pub bounds: Interval,
    /// What the landmarks leave open if the columns have no error: part of `bounds`. Its width says how well the landmarks
    /// know the pair.
    pub open: Interval,
}

/// The distance, in distances to the nearest landmarks, beyond which the value at equal points says nothing. Measured on
/// two scans; twice or half as much changes the mean error by less than a tenth.
const REACH: f64 = 2.0;

impl LandmarkMetric {
    /// Takes the columns. The first `n_exact` have no error, the others that of `error`. `rank` eigenpairs make the estimate,
    /// those of largest magnitude.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
    pub fn new(
        distances: &LandmarkDistances,
        n_exact: usize,
        error: ColumnError,
        rank: usize,
    ) -> Result<Self, NmdsError> {
        let factors = SqDistanceFactors::new(distances, rank)?;
        Ok(Self::of_parts(LandmarkBounds::new(distances, n_exact, error)?, factors))
    }

    /// The metric of bounds and factors of the same points.
    ///
    /// # Panics
    /// If their numbers of points differ.
    #[must_use]
    pub fn of_parts(bounds: LandmarkBounds, factors: SqDistanceFactors) -> Self {
        assert_eq!(bounds.n_points(), factors.n_points(), "bounds and factors of the same points");
        let local = (0..bounds.n_points())
            .map(|point| [f32::from(bounds.nearest(point)), factors.product(point, point) as f32])
            .collect();
        Self { bounds, factors, local }
    }

    /// Number of points p.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.bounds.n_points()
    }

    /// The interval of every pair.
    #[must_use]
    pub fn bounds(&self) -> &LandmarkBounds {
        &self.bounds
    }

    /// The approximation of the squared distances.
    #[must_use]
    pub fn factors(&self) -> &SqDistanceFactors {
        &self.factors
    }

    /// The largest distance of a point from its nearest landmark, in the unit of the distances.
    #[must_use]
    pub fn covering_radius(&self) -> f64 {
        let codes = self.local.iter().fold(0f32, |most, [nearest, _]| most.max(*nearest));
        f64::from(codes) * self.bounds.parts().quantum
    }

    /// What is known about the distance of two points, in the unit of the distances.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    pub fn pair(&self, a: usize, b: usize) -> PairEstimate {
        let (open, bounds) = self.bounds.of(a, b);
        let [[near_a, own_a], [near_b, own_b]] =
            [self.local[a], self.local[b]].map(|local| local.map(f64::from));
        let mut square = self.factors.product(a, b);
        let reach = REACH * (near_a + near_b) * self.bounds.parts().quantum;
        if reach > 0.0 {
            let far = open.lower / reach * (open.upper / reach);
            square -= 0.5 * (own_a + own_b) * (-far).exp();
        }
        let distance = square.max(0.0).sqrt() * self.factors.parts().quantum;
        let distance = distance.max(open.lower).min(open.upper);
        PairEstimate { distance, bounds, open }
    }
}

#[cfg(test)]
mod tests {
    use linalg::Matrix;

    use super::*;
    use crate::tests::support::{Cloud, landmark_distances, scaled};

    fn metric(distances: &LandmarkDistances, rank: usize) -> LandmarkMetric {
        LandmarkMetric::new(distances, distances.n_landmarks(), ColumnError::NONE, rank).unwrap()
    }

    #[test]
    fn points_in_space_are_estimated_exactly_and_lie_in_their_intervals() {
        let cloud = Cloud::new(200, 3, 1);
        let metric = metric(&landmark_distances(&cloud, 12), 5);
        let extent = (0..200).map(|i| cloud.distance(0, i)).fold(0.0, f64::max);
        for i in 0..200 {
            for j in 0..200 {
                let (pair, expected) = (metric.pair(i, j), cloud.distance(i, j));
                assert_eq!(pair, metric.pair(j, i));
                assert!(pair.bounds.contains(expected) && pair.bounds.contains(pair.distance), "{i} {j}");
                // Squares are stored with an error of 3e-5 of the largest.
                assert!((pair.distance.powi(2) - expected.powi(2)).abs() < 3e-4 * extent.powi(2), "{i} {j}");
            }
            assert_eq!(metric.pair(i, i).bounds, Interval { lower: 0.0, upper: 0.0 });
        }
    }

    #[test]
    fn another_unit_changes_nothing_but_the_unit() {
        let distances = landmark_distances(&Cloud::new(150, 4, 2), 20);
        let plain = metric(&distances, 10);
        for scale in [2f64.powi(-40), 2f64.powi(60)] {
            let other = metric(&scaled(&distances, scale), 10);
            for (i, j) in (0..150).map(|i| (i, (7 * i + 3) % 150)) {
                let (a, b) = (plain.pair(i, j), other.pair(i, j));
                assert_eq!(
                    [a.bounds.lower, a.bounds.upper].map(|d| d * scale),
                    [b.bounds.lower, b.bounds.upper]
                );
                assert!((a.distance * scale - b.distance).abs() <= 1e-6 * b.distance, "{i} {j}");
            }
        }
    }

    #[test]
    fn impossible_ranks_and_points_without_extent_are_refused() {
        let distances = landmark_distances(&Cloud::new(30, 2, 3), 5);
        for rank in [0, 6] {
            let fault = LandmarkMetric::new(&distances, 5, ColumnError::NONE, rank).unwrap_err();
            assert_eq!(fault, NmdsError::BadRank { rank, n_landmarks: 5 });
        }
        let zero = LandmarkDistances::new(vec![0], Matrix::zeros(3, 1)).unwrap();
        let fault = LandmarkMetric::new(&zero, 1, ColumnError::NONE, 1).unwrap_err();
        assert_eq!(fault, NmdsError::NoExtent(3));
    }
}
