//! A few eigenpairs of a large symmetric operator.

use base::Observer;

use crate::lanczos::Lanczos;
use crate::{LinalgError, SymmetricEigen, SymmetricOperator};

/// The residual up to which a pair counts as found, relative to the norm of the operator.
const TOLERANCE: f64 = 1e-11;

/// The `k` algebraically largest eigenpairs of a symmetric operator (fewer if its order is less than `k`, or if only zeros would
/// follow), to a residual of `1e-11` of its norm.
///
/// A block Lanczos process with full orthogonalisation, from a fixed start. It finds both ends of the spectrum: with many
/// eigenvalues of large magnitude below the wanted ones it takes up to `n` products.
///
/// Cost: `m` products and `O(n m^2)` operations for m a small multiple of `k`; `O(n m)` memory.
///
/// The budget of the observer is checked before every block of products.
///
/// # Errors
/// [`LinalgError::NotConverged`], [`LinalgError::Exceeded`].
///
/// ```
/// use canonform_linalg::{Matrix, SymmetricOperator, largest_eigenpairs};
///
/// /// The diagonal matrix of 1, 1/2, 1/3 and so on.
/// #[derive(Debug)]
/// struct Harmonic;
///
/// impl SymmetricOperator for Harmonic {
///     fn order(&self) -> usize {
///         300
///     }
///
///     fn apply(&self, columns: &Matrix) -> Matrix {
///         Matrix::from_fn(300, columns.ncols(), |i, j| columns[(i, j)] / (i + 1) as f64)
///     }
/// }
///
/// let eigen = largest_eigenpairs(&Harmonic, 2, &())?;
/// assert!((eigen.values[0] - 1.0).abs() < 1e-9 && (eigen.values[1] - 0.5).abs() < 1e-9);
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
pub fn largest_eigenpairs(
    operator: &dyn SymmetricOperator,
    k: usize,
    observer: &dyn Observer,
) -> Result<SymmetricEigen, LinalgError> {
    let budget = &observer.budget();
    let n = operator.order();
    let mut process = Lanczos::new(operator);
    let mut next = 2 * k + 16;
    loop {
        budget.check_memory(next.min(n).saturating_mul(n).saturating_mul(size_of::<f64>()))?;
        while process.dim() < next && !process.is_exhausted() {
            budget.check()?;
            process.step();
        }
        let ritz = process.ritz()?;
        let values = &ritz.eigen.values;
        let norm = values.first().zip(values.last()).map_or(0.0, |(first, last)| first.abs().max(last.abs()));
        // What the process does not reach is mapped to zero.
        let is_whole = process.dim() == n;
        let n_found = values.iter().take(k).take_while(|value| is_whole || **value > 0.0).count();
        let is_found = |j: usize| ritz.absolute_residual(j) <= TOLERANCE * norm;
        if process.is_exhausted() || (n_found == k && (0..k).all(is_found)) {
            let vectors = process.vectors(&ritz, n_found);
            return Ok(SymmetricEigen { values: values[..n_found].to_vec(), vectors });
        }
        next += next / 4;
    }
}
