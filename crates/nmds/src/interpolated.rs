//! Classical scaling of squared distances interpolated from those between samples.

use linalg::{LandmarkDistances, Matrix, symmetric_eigen, thin_qr};

use crate::embedding::center_columns;
use crate::{Embedding, NmdsError};

/// Classical scaling of `P S P'`: `interpolant` is the p x n matrix `P`, `S` are the squared distances
/// between the samples.
pub(crate) fn embed_interpolated(
    mut interpolant: Matrix,
    distances: &LandmarkDistances,
    dim: usize,
) -> Result<Embedding, NmdsError> {
    let n = distances.n_landmarks();
    if dim == 0 || dim > n {
        return Err(NmdsError::BadDimension { dim, limit: n });
    }
    let unit = distances.max();
    if unit <= 0.0 {
        return Err(NmdsError::NoExtent { n_points: distances.n_points() });
    }
    center_columns(&mut interpolant);
    let (q, w) = thin_qr(&interpolant);
    let middle = &w * (distances.sq_block() / (-2.0 * unit * unit)) * w.transpose();
    let inner = symmetric_eigen(&((&middle + middle.transpose()) * 0.5))?;
    let columns = q * inner.vectors.columns(0, dim);
    Ok(Embedding::from_orthonormal(columns, inner.values, unit, n))
}
