//! All squared distances as a product of thin factors.

use linalg::{LandmarkDistances, Matrix};
use rayon::prelude::*;

use crate::NmdsError;
use crate::passes::product;
use crate::regularization::by_magnitude;
use crate::squares::check_extent;

/// The Nystrom approximation of all squared distances, `Ê = R V Λ⁻¹ V' R' = Z S Z'`, with `Z` in 16 bits per entry.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `R` | `distances`, squared | p x n | the samples' columns |
/// | `V Λ V'` | | n x rank | the eigenpairs of largest magnitude of the rows of `R` at the samples |
/// | | `Z = R V abs(Λ)^(-1/2)` | p x rank | the factor |
/// | | `S` | rank | the signs of the eigenvalues, as a diagonal |
///
/// Without dropped eigenpairs the approximation would be exact at landmarks. It is best, however, with about half of them:
/// the small eigenvalues are those that the landmarks do not determine. One unit for all entries costs nothing, because the
/// largest entries dominate the error of a product.
#[derive(Debug, Clone, PartialEq)]
pub struct SqDistanceFactors {
    parts: FactorParts,
    n_points: usize,
}

/// What [`SqDistanceFactors`] consist of.
#[derive(Debug, Clone, PartialEq)]
pub struct FactorParts {
    /// Number of eigenpairs.
    pub rank: usize,
    /// How many of them, the first, have positive eigenvalues.
    pub n_positive: usize,
    /// What the codes count in, in the unit of the distances.
    pub quantum: f64,
    /// `Z`, p x rank, one row per point, in multiples of `quantum`.
    pub codes: Vec<i16>,
}

/// Numbers that are added up side by side.
const LANES: usize = 8;

impl SqDistanceFactors {
    /// Finds the factors with `rank` eigenpairs, fewer if the landmarks do not determine that many. Cost: `O(p n rank)`.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`] unless `rank` is in 1..=n; [`NmdsError::NoExtent`]; [`NmdsError::Linalg`].
    pub fn new(distances: &LandmarkDistances, rank: usize) -> Result<Self, NmdsError> {
        let (p, n) = (distances.n_points(), distances.n_landmarks());
        if !(1..=n).contains(&rank) {
            return Err(NmdsError::BadRank { rank, n_landmarks: n });
        }
        let unit = check_extent(distances.max(), p)?;
        let eigen = by_magnitude(&(distances.sq_block() / (unit * unit)), rank)?;
        let (positive, negative): (Vec<_>, Vec<_>) =
            (0..eigen.values.len()).partition(|&i| eigen.values[i] >= 0.0);
        let n_positive = positive.len();
        let eigen = eigen.select(&[positive, negative].concat());
        let mut basis = eigen.vectors;
        for (mut column, value) in basis.column_iter_mut().zip(&eigen.values) {
            column *= if *value == 0.0 { 0.0 } else { 1.0 / value.abs().sqrt() };
        }
        let z: Matrix = product(distances, unit, &vec![0.0; n], &basis)?;
        let (rank, step) = (z.ncols(), z.amax() / f64::from(i16::MAX));
        let mut codes = vec![0; p * rank];
        if step > 0.0 {
            codes.par_chunks_mut(rank).enumerate().for_each(|(point, codes)| {
                for (code, value) in codes.iter_mut().zip(z.row(point).iter()) {
                    *code = (value / step).round() as i16;
                }
            });
        }
        Ok(Self { parts: FactorParts { rank, n_positive, quantum: step * unit, codes }, n_points: p })
    }

    /// The factors of stored parts; `None` if they do not fit together.
    #[must_use]
    pub fn of_parts(parts: FactorParts) -> Option<Self> {
        let FactorParts { rank, n_positive, quantum, ref codes } = parts;
        let fits = rank > 0
            && n_positive <= rank
            && codes.len() % rank == 0
            && quantum >= 0.0
            && quantum.is_finite();
        let n_points = if fits { codes.len() / rank } else { 0 };
        fits.then_some(Self { n_points, parts })
    }

    /// What they consist of.
    #[must_use]
    pub fn parts(&self) -> &FactorParts {
        &self.parts
    }

    /// Number of points p.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    fn row(&self, point: usize) -> &[i16] {
        &self.parts.codes[point * self.parts.rank..][..self.parts.rank]
    }

    /// The approximation of a squared distance, in the squared unit of the distances; it may be negative.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    pub fn sq_distance(&self, a: usize, b: usize) -> f64 {
        self.product(a, b) * self.parts.quantum * self.parts.quantum
    }

    /// The same in squared quanta.
    #[inline]
    pub(super) fn product(&self, a: usize, b: usize) -> f64 {
        let (a, b) = (self.row(a), self.row(b));
        let (positive_a, negative_a) = a.split_at(self.parts.n_positive);
        let (positive_b, negative_b) = b.split_at(self.parts.n_positive);
        dot(positive_a, positive_b) - dot(negative_a, negative_b)
    }
}

/// The scalar product of two rows. Every product of two codes has 31 bits, so lanes of 32-bit floats lose a share of 6e-8 of
/// the largest term.
#[inline]
fn dot(a: &[i16], b: &[i16]) -> f64 {
    let mut sums = [0f32; LANES];
    let (blocks, rest) = a.as_chunks::<LANES>();
    let (other, other_rest) = b.as_chunks::<LANES>();
    for (a, b) in blocks.iter().zip(other) {
        for lane in 0..LANES {
            sums[lane] += f32::from(a[lane]) * f32::from(b[lane]);
        }
    }
    let rest: f64 = rest.iter().zip(other_rest).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
    sums.iter().map(|sum| f64::from(*sum)).sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::support::{Cloud, landmark_distances};

    #[test]
    fn the_product_equals_the_sum_of_products() {
        let wave = |i: usize, k: usize| ((((i * k) as f64).sin()) * 32767.0) as i16;
        for n in [0, 1, 7, 8, 9, 50] {
            let (a, b): (Vec<i16>, Vec<i16>) = (0..n).map(|i| (wave(i, 3), wave(i, 5))).unzip();
            let expected: i64 = a.iter().zip(&b).map(|(a, b)| i64::from(*a) * i64::from(*b)).sum();
            assert!((dot(&a, &b) - expected as f64).abs() < 1e-6 * 32767f64.powi(2), "{n}");
        }
    }

    #[test]
    fn landmarks_are_exact_if_no_eigenpair_is_dropped() {
        let cloud = Cloud::new(80, 30, 6);
        let distances = landmark_distances(&cloud, 20);
        let factors = SqDistanceFactors::new(&distances, 20).unwrap();
        let largest = distances.max().powi(2);
        for (i, j) in (0..20).flat_map(|i| (0..80).map(move |j| (i, j))) {
            let gap = factors.sq_distance(i, j) - cloud.distance(i, j).powi(2);
            assert!(gap.abs() < 1e-3 * largest, "{i} {j}: {gap}");
        }
    }

    #[test]
    fn parts_that_do_not_fit_together_are_refused() {
        let whole = SqDistanceFactors::new(&landmark_distances(&Cloud::new(10, 2, 1), 5), 3).unwrap();
        let parts = whole.parts().clone();
        assert_eq!(SqDistanceFactors::of_parts(parts.clone()), Some(whole));
        for broken in [
            FactorParts { rank: 0, ..parts.clone() },
            FactorParts { rank: 4, ..parts.clone() },
            FactorParts { n_positive: 4, ..parts.clone() },
            FactorParts { quantum: -1.0, ..parts.clone() },
            FactorParts { quantum: f64::NAN, ..parts },
        ] {
            assert_eq!(SqDistanceFactors::of_parts(broken), None);
        }
    }
}
