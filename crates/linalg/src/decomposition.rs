//! Dense decompositions.

use faer::{Mat, MatRef, Side};

use crate::{LinalgError, Matrix};

/// Eigenvalues and eigenvectors, one column each.
#[derive(Debug, Clone, PartialEq)]
pub struct SymmetricEigen {
    /// Eigenvalues, largest first, or smallest first if the smallest were sought.
    pub values: Vec<f64>,
    /// Eigenvectors as columns, in the order of `values`.
    pub vectors: Matrix,
}

impl SymmetricEigen {
    /// The eigenpairs with the indices `order`, in that order.
    pub fn select(&self, order: &[usize]) -> Self {
        Self {
            values: order.iter().map(|&i| self.values[i]).collect(),
            vectors: self.vectors.select_columns(order),
        }
    }
}

/// The sign, 1 or -1, of the first entry of at least 0.999 times the largest magnitude: multiplied by it, a column has
/// a reproducible sign. (The largest entry itself is not reproducible: rounding may reorder nearly equal ones.)
pub fn leading_sign(column: &[f64]) -> f64 {
    let largest = column.iter().fold(0.0f64, |largest, x| largest.max(x.abs()));
    match column.iter().find(|x| x.abs() >= 0.999 * largest) {
        Some(lead) if *lead < 0.0 => -1.0,
        _ => 1.0,
    }
}

/// A view of a nalgebra matrix for faer, without a copy.
pub(crate) fn view(a: &Matrix) -> MatRef<'_, f64> {
    MatRef::from_column_major_slice(a.as_slice(), a.nrows(), a.ncols())
}

/// The matrix for faer, which need not end on numbers that are not finite.
fn finite(a: &Matrix) -> Result<MatRef<'_, f64>, LinalgError> {
    match a.iter().all(|x| x.is_finite()) {
        true => Ok(view(a)),
        false => Err(LinalgError::NotConverged(a.nrows().max(a.ncols()))),
    }
}

/// Converts a faer matrix to nalgebra.
pub(crate) fn from_faer(a: MatRef<'_, f64>) -> Matrix {
    Matrix::from_fn(a.nrows(), a.ncols(), |i, j| a[(i, j)])
}

/// All eigenpairs of a symmetric matrix. Reads only its lower triangle.
///
/// Cost: `O(n^3)` time, `O(n^2)` memory.
///
/// # Errors
/// [`LinalgError::NotConverged`], also if an entry is not finite.
///
/// ```
/// use canonform_linalg::{Matrix, symmetric_eigen};
///
/// let eigen = symmetric_eigen(&Matrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]))?;
/// assert!((eigen.values[0] - 3.0).abs() < 1e-12 && (eigen.values[1] - 1.0).abs() < 1e-12);
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
pub fn symmetric_eigen(a: &Matrix) -> Result<SymmetricEigen, LinalgError> {
    let n = a.nrows();
    let eigen = finite(a)?.self_adjoint_eigen(Side::Lower).map_err(|_| LinalgError::NotConverged(n))?;
    // faer sorts ascending.
    let (s, u) = (eigen.S(), eigen.U());
    Ok(SymmetricEigen {
        values: (0..n).rev().map(|i| s[i]).collect(),
        vectors: Matrix::from_fn(n, n, |i, j| u[(i, n - 1 - j)]),
    })
}

/// The eigenvalues of a symmetric matrix, in descending order, in a fraction of the time of [`symmetric_eigen`]. Only the lower
/// triangle is read.
///
/// # Errors
/// [`LinalgError::NotConverged`], also if an entry is not finite.
pub fn symmetric_eigenvalues(a: &Matrix) -> Result<Vec<f64>, LinalgError> {
    let n = a.nrows();
    let ascending =
        finite(a)?.self_adjoint_eigenvalues(Side::Lower).map_err(|_| LinalgError::NotConverged(n))?;
    Ok(ascending.into_iter().rev().collect())
}

/// The thin QR decomposition of a p x n matrix with p >= n: an orthonormal p x n `Q` and an upper
/// triangular n x n `R`.
///
/// `Q` is orthonormal even if `a` is rank deficient. Cost: `O(p n^2)`.
pub fn thin_qr(a: &Matrix) -> (Matrix, Matrix) {
    let qr = view(a).qr();
    let q: Mat<f64> = qr.compute_thin_Q();
    (from_faer(q.as_ref()), from_faer(qr.thin_R()))
}

/// The upper triangular factor of [`thin_qr`] alone, min(p, n) x n, up to the signs of its rows.
///
/// Cost: `O(p n^2)`.
pub fn triangular_factor(a: &Matrix) -> Matrix {
    from_faer(view(a).qr().thin_R())
}

/// The singular value decomposition `A = U Σ V'`: `U`, the singular values above `max(rows, columns) * 2.2e-16` of the largest,
/// descending, and `V`. What is not above counts as zero.
///
/// Cost: `O(m n min(m, n))`.
///
/// # Errors
/// [`LinalgError::NotConverged`], also if an entry is not finite.
pub fn thin_svd(a: &Matrix) -> Result<(Matrix, Vec<f64>, Matrix), LinalgError> {
    let n = a.nrows().max(a.ncols());
    if a.is_empty() {
        return Ok((Matrix::zeros(a.nrows(), 0), Vec::new(), Matrix::zeros(a.ncols(), 0)));
    }
    let svd = finite(a)?.thin_svd().map_err(|_| LinalgError::NotConverged(n))?;
    let all: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let floor = n as f64 * f64::EPSILON * all[0];
    let values: Vec<f64> = all.into_iter().take_while(|value| *value > floor).collect();
    let [u, v] = [svd.U(), svd.V()].map(|of| from_faer(of.subcols(0, values.len())));
    Ok((u, values, v))
}

/// The pseudo-inverse of a matrix, by its [`thin_svd`].
///
/// # Errors
/// As [`thin_svd`].
pub fn pseudo_inverse(a: &Matrix) -> Result<Matrix, LinalgError> {
    let (u, values, mut v) = thin_svd(a)?;
    v.column_iter_mut().zip(values).for_each(|(mut column, value)| column /= value);
    Ok(v * u.transpose())
}
