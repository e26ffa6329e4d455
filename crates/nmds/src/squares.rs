//! What the embeddings from squared distances have in common.

use linalg::{Matrix, SymmetricEigen};

use crate::NmdsError;

/// Returns the largest distance if it is positive.
///
/// # Errors
/// [`NmdsError::NoExtent`].
pub(crate) fn check_extent(largest: f64, n_points: usize) -> Result<f64, NmdsError> {
    if largest > 0.0 { Ok(largest) } else { Err(NmdsError::NoExtent(n_points)) }
}

/// A unit near a length: a power of two, so that dividing by it is exact; 1 if the length is zero.
pub(crate) fn unit_near(length: f64) -> f64 {
    if length > 0.0 { 2f64.powi(length.log2().floor() as i32) } else { 1.0 }
}

/// # Errors
/// [`NmdsError::PointMismatch`] unless `given` is the number of points of the distances.
pub(crate) fn check_points(given: usize, n_points: usize) -> Result<(), NmdsError> {
    if given == n_points { Ok(()) } else { Err(NmdsError::PointMismatch { given, n_points }) }
}

/// # Errors
/// [`NmdsError::BadDimension`] unless `dim` is in 1..=limit.
pub(crate) fn check_dim(dim: usize, limit: usize) -> Result<(), NmdsError> {
    if (1..=limit).contains(&dim) { Ok(()) } else { Err(NmdsError::BadDimension { dim, limit }) }
}

/// `(A + A') / 2`.
pub(crate) fn symmetrized(a: Matrix) -> Matrix {
    (&a + a.transpose()) * 0.5
}

/// Subtracts its mean from each column: the product with `J = I - 11'/p` from the left.
pub(crate) fn center_columns(columns: &mut Matrix) {
    let p = columns.nrows().max(1) as f64;
    for mut column in columns.column_iter_mut() {
        let mean = column.sum() / p;
        column.add_scalar_mut(-mean);
    }
}

/// The positive ones of the first `k` eigenpairs of an indefinite matrix, above the rounding of these numbers.
pub(crate) fn positive_pairs(eigen: &SymmetricEigen, k: usize) -> SymmetricEigen {
    let floor = eigen.values.len() as f64 * f64::EPSILON * eigen.values[0].abs();
    eigen.select(&(0..k).filter(|&i| eigen.values[i] > floor).collect::<Vec<_>>())
}

/// The magnitude below which eigenvalues may be rounding. Coordinates in files have 32 bits: this is the usual tolerance of a
/// rank, the order times the `ε` of such numbers times the largest magnitude.
pub(crate) fn rounding(values: &[f64], order: usize) -> f64 {
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    order as f64 * f64::from(f32::EPSILON) * largest
}

/// An eigenfunction whose root mean square on all points is more times that at the samples is made of errors. On meshes the ratio
/// is 0.8 to 1.3 with farthest point sampling; on flat ones it is 40 to 10^10 for eigenvalues that should be zero. A convention.
const EXTENDED: f64 = 10.0;

/// The number of leading eigenpairs of a matrix of `n` samples that count; `values` are in descending order of magnitude.
///
/// Eigenvalues below [rounding] are zero, unless the distances to all `p` points confirm them: an eigenvector, extended to all
/// points, has about the mean square that it has at the samples, while errors do not shrink with the eigenvalue. `squares` are the
/// sums of squares of each eigenfunction, at the samples and on all points. Dividing by what fails this test would amplify errors
/// without bound.
pub(crate) fn n_significant(
    values: &[f64],
    squares: impl Iterator<Item = [f64; 2]>,
    n: usize,
    p: usize,
) -> usize {
    let rounding = rounding(values, n);
    let counts = |(value, [at_samples, everywhere]): (&f64, [f64; 2])| {
        value.abs() > rounding || everywhere * n as f64 <= EXTENDED.powi(2) * at_samples * p as f64
    };
    values.iter().zip(squares).take_while(|pair| counts(*pair)).count()
}
