//! Landmark multidimensional scaling: the projection of Landmark Isomap.

use linalg::{LandmarkDistances, symmetric_eigen};

use crate::embedding::negative_mass;
use crate::passes::product;
use crate::squares::{center_columns, check_dim, check_extent, n_significant, positive_pairs, symmetrized};
use crate::{Embedding, NmdsError};

/// Landmark MDS: embeds the n landmarks by classical scaling and places all points by their distances from them.
///
/// | symbol | here | shape | meaning |
/// |---|---|---|---|
/// | `S` | `block` | n x n | squared distances between landmarks |
/// | `V L V'` | `kept` | n x k | largest positive eigenpairs of `-1/2 J S J` |
/// | `δ_a - μ` | `columns` | p x n | squared distances of point a from the landmarks, minus the mean row of `S` |
/// | `x_a` | result | p x k | `-1/2 L^(-1/2) V' (δ_a - μ)`, centered and rotated to its principal axes |
///
/// * Cost: `O(p n k)` time, `O(p k + n^2)` memory besides the distances, which may be in a file.
/// * Exact for Euclidean distances in `R^k` from landmarks in general position (`n >= k + 1`). Otherwise the subspace
///   depends on the landmarks only, so the stress stays above the optimum for any number of them.
/// * The `eigenvalues` of the result are the k of its coordinates; its `negative_mass` is that of the landmarks.
///
/// After de Silva and Tenenbaum 2002 (`desilva2002` in `REFERENCES.bib`).
///
/// # Errors
/// [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
pub fn landmark_mds(distances: &LandmarkDistances, dim: usize) -> Result<Embedding, NmdsError> {
    let n = distances.n_landmarks();
    // Centering removes one dimension.
    check_dim(dim, n.saturating_sub(1))?;
    let unit = check_extent(distances.max(), distances.n_points())?;
    let mut block = distances.sq_block() / (unit * unit);
    let means = block.row_mean();
    center_columns(&mut block);
    let mut gram = block.transpose() * -0.5;
    center_columns(&mut gram);
    let eigen = symmetric_eigen(&symmetrized(gram))?;
    let kept = positive_pairs(&eigen, dim);
    let mut axes = kept.vectors * -0.5;
    for (mut axis, value) in axes.column_iter_mut().zip(&kept.values) {
        axis /= value.sqrt();
    }
    let mut coords = product(distances, unit, means.as_slice(), &axes.resize_horizontally(dim, 0.0))?;
    center_columns(&mut coords);
    let squares =
        kept.values.iter().zip(coords.column_iter()).map(|(value, column)| [*value, column.norm_squared()]);
    let rank = n_significant(&kept.values, squares, n, distances.n_points());
    coords.columns_mut(rank, dim - rank).fill(0.0);
    let embedding = Embedding::along_principal_axes(coords, unit, rank)?;
    Ok(Embedding { negative_mass: negative_mass(&eigen.values), ..embedding })
}
