//! How well a few columns of squared distances reconstruct all of them.

use linalg::{LandmarkDistances, Matrix, thin_qr};

use crate::passes::product;
use crate::regularization::largest_magnitudes;
use crate::squares::{check_extent, check_points};
use crate::{DistanceRows, NmdsError, Regularization};

/// The error of an approximation `Ê` of the matrix `E` of all squared distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReconstructionError {
    /// `‖Ê - E‖_F / ‖E‖_F`, which has no unit.
    pub relative: f64,
    /// `‖Ê - E‖_F² / p²`, in the fourth power of the unit of length, as in Fig. 5 and 6 of the paper.
    pub mean_square: f64,
}

/// Errors of approximations `Ê = R X R'` of a matrix `E` of squared distances by n of its columns `R`: that of each
/// [`Regularization`], and the smallest possible.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `E` | squares of `rows` | p x p | all squared distances; symmetric |
/// | `R` | squares of `distances` | p x n | the samples' columns |
/// | `Q` | of the QR decomposition of `R` | p x n | orthonormal basis of the columns of `Ê` |
/// | `RR⁺E` | `Q Q' E` | p x p | projection of `E`, the best approximation with columns in the span of `R` (eq. 5) |
///
/// With `A = Q' E Q` and `Ê = Q Â Q'`, the error is a sum of squares without cancellation:
/// `‖E - Ê‖² = ‖E - QQ'E‖² + ‖Q'E - A Q'‖² + ‖A - Â‖²`. The first term is the error of the best projection, the first two
/// that of the best symmetric `X`, and only the last depends on the regularization.
///
/// * Cost: [`Self::new`] takes `O(p^2 n)` time and `O(p^2)` memory; each error `O(n^3)` time.
/// * `rows` and `distances` may come from different solvers, for example an approximation from hop counts.
#[derive(Debug)]
pub struct Reconstruction {
    /// The largest distance: squares are in units of `unit²`, so that results do not depend on the unit of length.
    unit: f64,
    /// `R`, p x n, and its rows at the samples, n x n.
    columns: Matrix,
    block: Matrix,
    q: Matrix,
    /// `A`, n x n.
    projected: Matrix,
    /// `‖E‖²`, `‖E - QQ'E‖²` and `‖Q'E - A Q'‖²`.
    norm_sq: f64,
    outside_sq: f64,
    mixed_sq: f64,
}

impl Reconstruction {
    /// Takes the samples' columns and the rows of all distances.
    ///
    /// # Errors
    /// [`NmdsError::PointMismatch`], [`NmdsError::NoExtent`], [`NmdsError::Exceeded`].
    pub fn new(distances: &LandmarkDistances, rows: &dyn DistanceRows) -> Result<Self, NmdsError> {
        let p = rows.n_points();
        check_points(distances.n_points(), p)?;
        let unit = check_extent(distances.max(), p)?;
        let columns = distances.to_matrix()?.map(|d| (d / unit).powi(2));
        let (q, _) = thin_qr(&columns);
        let mut squares = Matrix::zeros(p, p);
        for (i, mut column) in squares.column_iter_mut().enumerate() {
            rows.row_into(i, column.as_mut_slice())?;
        }
        squares.apply(|d| *d = (*d / unit).powi(2));
        let norm_sq = squares.norm_squared();
        // E Q, the transpose of Q' E.
        let image = &squares * &q;
        let projected = q.tr_mul(&image);
        let mixed_sq = (&image - &q * projected.transpose()).norm_squared();
        squares.gemm(-1.0, &q, &image.transpose(), 1.0);
        let outside_sq = squares.norm_squared();
        let block = distances.sq_block() / (unit * unit);
        Ok(Self { unit, columns, block, projected, norm_sq, outside_sq, mixed_sq, q })
    }

    /// The error of `RR⁺E` (eq. 5), which requires all of `E`: the reference in Fig. 6.
    pub fn best_projection(&self) -> ReconstructionError {
        self.error_of(self.outside_sq)
    }

    /// The error of the Nystrom approximation with this regularization, by eq. 4, 3 or 9. The default rank is that for three
    /// dimensions.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`], [`NmdsError::BadAlpha`], [`NmdsError::Linalg`].
    pub fn error(&self, regularization: Regularization) -> Result<ReconstructionError, NmdsError> {
        let rank = regularization.rank(self.block.nrows(), 3)?;
        let inverse = regularization.pseudo_inverse(&self.block, self.unit, rank)?;
        let projected = self.q.tr_mul(&(&self.columns * &inverse.basis));
        let approximated = &projected * inverse.core() * projected.transpose();
        let inside_sq = (&self.projected - approximated).norm_squared();
        Ok(self.error_of(self.outside_sq + self.mixed_sq + inside_sq))
    }

    fn error_of(&self, sum_sq: f64) -> ReconstructionError {
        let p = self.columns.nrows() as f64;
        let relative = if self.norm_sq > 0.0 { (sum_sq / self.norm_sq).sqrt() } else { 0.0 };
        ReconstructionError { relative, mean_square: sum_sq * self.unit.powi(4) / (p * p) }
    }
}

/// The eigenvalues of the squared distances between samples (`S`), largest magnitude first, in the squared unit of the
/// distances, without those at rounding error. The first is the `σ1` of [`RpiAlpha`](crate::RpiAlpha).
///
/// # Errors
/// [`NmdsError::Linalg`].
pub fn sample_eigenvalues(distances: &LandmarkDistances) -> Result<Vec<f64>, NmdsError> {
    let unit = if distances.max() > 0.0 { distances.max() } else { 1.0 };
    let kept = largest_magnitudes(&(distances.sq_block() / (unit * unit)), distances.n_landmarks())?;
    Ok(kept.values.iter().map(|value| value * unit * unit).collect())
}

/// The factor `Z` (p x rank) of the Nystrom approximation of all squared distances, `Ê = R V Λ⁻¹ V' R' = Z S Z'`, in the unit of the
/// distances, and how many of its columns, the first, have positive signs.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `R` | `distances`, squared | p x n | the samples' columns |
/// | `V Λ V'` | | n x rank | the eigenpairs of largest magnitude of the rows of `R` at the samples |
/// | | `Z = R V abs(Λ)^(-1/2)` | p x rank | the factor |
/// | | `S` | rank | the signs of the eigenvalues, as a diagonal |
///
/// Without dropped eigenpairs the approximation would be exact at samples. It is best, however, with about half of them: the small
/// eigenvalues are those that the samples do not determine. There are fewer than `rank` if others are rounding. Cost: `O(p n rank)`.
///
/// # Errors
/// [`NmdsError::BadRank`] unless `rank` is in 1..=n; [`NmdsError::NoExtent`]; [`NmdsError::Linalg`].
pub fn low_rank_factor(distances: &LandmarkDistances, rank: usize) -> Result<(Matrix, usize), NmdsError> {
    let n = distances.n_landmarks();
    let rank = Regularization::LowRank { rank: Some(rank) }.rank(n, 3)?;
    let unit = check_extent(distances.max(), distances.n_points())?;
    let eigen = largest_magnitudes(&(distances.sq_block() / (unit * unit)), rank)?;
    let (positive, negative): (Vec<_>, Vec<_>) =
        (0..eigen.values.len()).partition(|&i| eigen.values[i] >= 0.0);
    let n_positive = positive.len();
    let eigen = eigen.select(&[positive, negative].concat());
    let mut basis = eigen.vectors;
    for (mut column, value) in basis.column_iter_mut().zip(&eigen.values) {
        column *= if *value == 0.0 { 0.0 } else { unit / value.abs().sqrt() };
    }
    Ok((product(distances, unit, &vec![0.0; n], &basis)?, n_positive))
}
