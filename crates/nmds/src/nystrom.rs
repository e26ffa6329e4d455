//! Nystrom multidimensional scaling.

use linalg::{LandmarkDistances, Matrix, SymmetricEigen, symmetric_eigen};

use crate::out_of_sample::OutOfSample;
use crate::passes::{product, sq_means, triangle};
use crate::squares::{check_extent, rounding, symmetrized};
use crate::{Embedding, NmdsError, Regularization};

/// Nystrom multidimensional scaling (NMDS): embeds `p` points from `n << p` columns of distances.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `R` | `columns` | p x n | squared distances to the landmarks |
/// | `S` | `block` | n x n | its rows at the landmarks; symmetric, **indefinite** |
/// | `V~ Λ~⁻¹ V~'` | `inverse` | n x n | its regularized pseudo-inverse, in factors |
/// | `Q W` | `q`, `w` | p x n1, n1 x n1 | QR decomposition of `J R V~` |
/// | `Z` | result | p x k | coordinates, columns by descending eigenvalue |
///
/// `Z = Q U √L` with the `k` algebraically largest eigenpairs `U L U'` of `-1/2 W Λ~⁻¹ W'`
/// (Procedure 2, eq. 13 to 16; `shamai2015` in `REFERENCES.bib`). For [`Regularization::Cur`], `Q W = J R` and the
/// inner matrix is `-1/4 W (P U + U' P') W'` with `P` the first n1 columns of the identity. (The paper decomposes
/// `J [C R]`, which is redundant because `C` is part of `R`.)
///
/// * Cost: `O(p n n1)` time; n1 is n except for [`Regularization::LowRank`]. Reads the distances three times, in blocks of
///   rows, and needs `O(p k + n^2)` memory besides them; they may be in a file.
/// * Exact for Euclidean distances in `R^d` if `n1 >= d + 2`.
/// * Independent of the unit of length, except for [`RpiAlpha::Paper`](crate::RpiAlpha::Paper).
/// * Drops eigenvalues of `S` below the rounding error of coordinates of 32 bits, even if the rank includes them, unless the
///   distances to all points confirm them. Drops negative eigenvalues of the result, whose share it reports. Never returns NaN.
///
/// **Deviation**: "the n1 largest eigenvalues of S" are those of largest *magnitude*. `S` has one large positive
/// eigenvalue, and the negative ones carry the geometry; in algebraic order the stress stays near four times the
/// optimum for any n. `J` is `I - 11'/p` (the paper prints 1/n).
///
/// # Errors
/// [`NmdsError::BadRank`], [`NmdsError::BadAlpha`], [`NmdsError::BadDimension`], [`NmdsError::NoExtent`],
/// [`NmdsError::Linalg`].
///
/// ```
/// # extern crate linalg as canonform_linalg;
/// use canonform_linalg::{LandmarkDistances, Matrix};
/// use canonform_nmds::{Regularization, nystrom};
///
/// // 100 points on a quarter circle of radius 1, and their distances along the arc from 10 of them.
/// let angle = |i: usize| i as f64 / 99.0 * std::f64::consts::FRAC_PI_2;
/// let landmarks: Vec<usize> = (0..10).map(|j| 11 * j).collect();
/// let columns = Matrix::from_fn(100, 10, |i, j| (angle(i) - angle(landmarks[j])).abs());
/// let distances = LandmarkDistances::new(landmarks, columns)?;
///
/// // Along the arc the points are on a line.
/// let embedding = nystrom(&distances, Regularization::default(), 1)?;
/// let length = embedding.coords[(0, 0)] - embedding.coords[(99, 0)];
/// assert!((length.abs() - std::f64::consts::FRAC_PI_2).abs() < 1e-9);
/// # Ok::<(), canonform_nmds::NmdsError>(())
/// ```
pub fn nystrom(
    distances: &LandmarkDistances,
    regularization: Regularization,
    dim: usize,
) -> Result<Embedding, NmdsError> {
    Ok(nystrom_extended(distances, regularization, dim)?.0)
}

/// As [`nystrom`], with the map that places further points.
///
/// # Errors
/// As [`nystrom`].
pub fn nystrom_extended(
    distances: &LandmarkDistances,
    regularization: Regularization,
    dim: usize,
) -> Result<(Embedding, OutOfSample), NmdsError> {
    let unit = check_extent(distances.max(), distances.n_points())?;
    let rank = regularization.rank_in(distances.n_landmarks(), dim)?;
    let block = distances.sq_block() / (unit * unit);
    let inverse = regularization.pseudo_inverse(&block, unit, rank)?;

    let means = sq_means(distances, unit)?;
    let w = triangle(distances, unit, &means, &inverse.basis)?;
    let inverse = inverse.without_rounding(&w, distances);
    let core = symmetrized(inverse.core()) * -0.5;
    let inner = symmetrized(&w * &core * w.transpose());
    let (axes, values) = principal_axes(&(core * w.transpose()), &inner, dim)?;
    let mut axes = &inverse.basis * axes;
    let columns = product(distances, unit, &means, &axes)?;
    let (embedding, factors) = Embedding::from_orthonormal(columns, values, unit, inverse.rank());
    axes.column_iter_mut().zip(factors).for_each(|(mut axis, factor)| axis *= factor);
    Ok((embedding, OutOfSample { unit, means, axes }))
}

/// The axes `A` for which `X A = Q U`, and all eigenvalues, descending, for `X = Q W`, `inner = W C W' = U L U'` and
/// `half = C W'`: from `U = inner U L⁻¹` follows `A = half U L⁻¹`, without `Q` and without an inverse of `W`, which may be
/// singular. An eigenvalue that is not above [rounding] is zero, and so is its axis.
fn principal_axes(half: &Matrix, inner: &Matrix, dim: usize) -> Result<(Matrix, Vec<f64>), NmdsError> {
    let SymmetricEigen { mut values, vectors } = symmetric_eigen(inner)?;
    let floor = rounding(&values, values.len());
    let mut axes = (half * vectors.columns(0, dim.min(values.len()))).resize_horizontally(dim, 0.0);
    for (mut axis, value) in axes.column_iter_mut().zip(&mut values) {
        *value = if value.abs() > floor { *value } else { 0.0 };
        axis *= if *value > 0.0 { 1.0 / *value } else { 0.0 };
    }
    Ok((axes, values))
}
