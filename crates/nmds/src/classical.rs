//! Classical multidimensional scaling.

use base::Observer;
use linalg::{
    DistanceMatrix, LinalgError, Matrix, SymmetricEigen, SymmetricOperator, largest_eigenpairs,
    symmetric_eigen,
};
use rayon::prelude::*;

use crate::squares::{center_columns, check_dim, check_extent};
use crate::{Embedding, NmdsError};

/// Classical multidimensional scaling: the coordinates `Z = U √L` from the `dim` largest eigenpairs of
/// `B = -1/2 J E J`, with `E_ij = d_ij^2` and `J = I - 11'/p`.
///
/// * Minimizes the strain `‖Z Z' - B‖`; exact for Euclidean distances.
/// * `eigenvalues` holds only `dim` values, so `negative_mass` does not cover the rest; see [`classical_full`].
/// * Cost: `O(p^2)` per step of a Krylov iteration; `O(p)` memory besides the distances.
///
/// # Errors
/// [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`], also if the budget of the
/// observer is exceeded.
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::DistanceMatrix;
///
/// // The corners of a 3 x 4 rectangle.
/// let corners = [[0.0_f64, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 4.0]];
/// let distances = DistanceMatrix::from_pairs(4, |i, j| {
///     (corners[i][0] - corners[j][0]).hypot(corners[i][1] - corners[j][1])
/// })?;
/// let coords = canonform_nmds::classical(&distances, 2, &())?.coords;
/// assert!(((coords.row(0) - coords.row(2)).norm() - 5.0).abs() < 1e-9);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
pub fn classical(
    distances: &DistanceMatrix,
    dim: usize,
    observer: &dyn Observer,
) -> Result<Embedding, NmdsError> {
    embed(distances, dim, |operator| largest_eigenpairs(operator, dim, observer))
}

/// [`classical`] by the full decomposition, with all eigenvalues and thus the true negative mass.
///
/// Cost: `O(p^3)` time, `O(p^2)` memory.
///
/// # Errors
/// As [`classical`].
pub fn classical_full(distances: &DistanceMatrix, dim: usize) -> Result<Embedding, NmdsError> {
    embed(distances, dim, |operator| symmetric_eigen(&operator.dense()))
}

fn embed(
    distances: &DistanceMatrix,
    dim: usize,
    decompose: impl FnOnce(&CenteredSquares<'_>) -> Result<SymmetricEigen, LinalgError>,
) -> Result<Embedding, NmdsError> {
    let p = distances.n_points();
    check_dim(dim, p)?;
    let unit = check_extent(distances.max(), p)?;
    let eigen = decompose(&CenteredSquares { distances, unit })?;
    let columns = eigen.vectors.resize_horizontally(dim, 0.0);
    let rank = eigen.values.len();
    Ok(Embedding::from_orthonormal(columns, eigen.values, unit, rank).0)
}

/// The matrix `-1/2 J E J` of distances in units of `unit`, as an operator.
#[derive(Debug)]
struct CenteredSquares<'a> {
    distances: &'a DistanceMatrix,
    unit: f64,
}

impl CenteredSquares<'_> {
    fn dense(&self) -> Matrix {
        let p = self.order();
        let square = |i: usize, j: usize| (self.distances.get(i, j) / self.unit).powi(2);
        let means: Vec<f64> = (0..p).map(|i| (0..p).map(|j| square(i, j)).sum::<f64>() / p as f64).collect();
        let mean = means.iter().sum::<f64>() / p as f64;
        Matrix::from_fn(p, p, |i, j| -0.5 * (square(i, j) - means[i] - means[j] + mean))
    }
}

impl SymmetricOperator for CenteredSquares<'_> {
    fn order(&self) -> usize {
        self.distances.n_points()
    }

    fn apply(&self, columns: &Matrix) -> Matrix {
        let mut x = columns.clone();
        center_columns(&mut x);
        let factor = -0.5 / (self.unit * self.unit);
        let mut result = Matrix::zeros(x.nrows(), x.ncols());
        for (x, mut y) in x.column_iter().zip(result.column_iter_mut()) {
            let x = x.as_slice();
            y.as_mut_slice().par_iter_mut().enumerate().for_each(|(i, out)| {
                // Four independent chains of additions.
                let mut sums = [0.0; 4];
                let (row, x) = (self.distances.row(i).chunks_exact(4), x.chunks_exact(4));
                let tail: f64 = row.remainder().iter().zip(x.remainder()).map(|(d, x)| d * d * x).sum();
                for (d, x) in row.zip(x) {
                    for lane in 0..4 {
                        sums[lane] += d[lane] * d[lane] * x[lane];
                    }
                }
                *out = factor * (sums.iter().sum::<f64>() + tail);
            });
        }
        center_columns(&mut result);
        result
    }
}
