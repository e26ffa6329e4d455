//! Distances between all pairs of points.

use rayon::prelude::*;

use crate::LinalgError;

/// The n x n matrix of distances between n points, stored row by row.
///
/// **Invariant.** Symmetric, finite, not negative, zero on the diagonal.
///
/// ```
/// use canonform_linalg::DistanceMatrix;
///
/// let distances = DistanceMatrix::from_rows(2, vec![0.0, 2.0, 4.0, 0.0])?;
/// assert_eq!(distances.get(0, 1), 3.0); // the mean of both directions
/// assert!(DistanceMatrix::from_pairs(2, |_, _| f64::NAN).is_err());
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct DistanceMatrix {
    n: usize,
    values: Vec<f64>,
}

impl DistanceMatrix {
    /// Takes n x n distances row by row and averages the two directions of each pair, which may differ by rounding or
    /// by the error of the solver.
    ///
    /// # Errors
    /// [`LinalgError::Shape`], [`LinalgError::BadDistance`].
    pub fn from_rows(n: usize, mut values: Vec<f64>) -> Result<Self, LinalgError> {
        if values.len() != n * n {
            return Err(LinalgError::Shape { n_rows: n, n_columns: n, actual: values.len() });
        }
        if let Some(bad) = first_invalid(&values) {
            return Err(LinalgError::BadDistance { row: bad / n, column: bad % n, value: values[bad] });
        }
        for i in 0..n {
            values[i * n + i] = 0.0;
            for j in 0..i {
                let mean = 0.5 * (values[i * n + j] + values[j * n + i]);
                values[i * n + j] = mean;
                values[j * n + i] = mean;
            }
        }
        Ok(Self { n, values })
    }

    /// Evaluates `distance(i, j)` for each pair `i < j`, in parallel.
    ///
    /// # Errors
    /// [`LinalgError::BadDistance`] for the first value that is NaN, infinite or negative.
    pub fn from_pairs(n: usize, distance: impl Fn(usize, usize) -> f64 + Sync) -> Result<Self, LinalgError> {
        let mut values = vec![0.0; n * n];
        let one_row = |(i, row): (usize, &mut [f64])| (i + 1..n).for_each(|j| row[j] = distance(i, j));
        values.par_chunks_mut(n.max(1)).enumerate().for_each(one_row);
        for i in 0..n {
            for j in 0..i {
                values[i * n + j] = values[j * n + i];
            }
        }
        Self::from_rows(n, values)
    }

    /// Number of points.
    pub fn n_points(&self) -> usize {
        self.n
    }

    /// The distance between points `i` and `j`.
    #[inline]
    pub fn get(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.n + j]
    }

    /// The distances from point `i` to all points.
    #[inline]
    pub fn row(&self, i: usize) -> &[f64] {
        &self.values[i * self.n..(i + 1) * self.n]
    }

    /// All values, row by row.
    pub fn as_slice(&self) -> &[f64] {
        &self.values
    }

    /// The largest distance; zero if there are no points.
    pub fn max(&self) -> f64 {
        self.values.iter().copied().fold(0.0, f64::max)
    }
}

/// The position of the first value that is not a distance.
pub(crate) fn first_invalid(values: &[f64]) -> Option<usize> {
    values.iter().position(|d| !(d.is_finite() && *d >= 0.0))
}
