//! Regularized inverses of the sample matrix.

use linalg::{LandmarkDistances, LinalgError, Matrix, SymmetricEigen, symmetric_eigen, thin_svd};

use crate::squares::{check_dim, n_significant};
use crate::{NmdsError, SampleSearch};

/// How the pseudo-inverse `S⁺` in the Nystrom approximation `Ê = R S⁺ R'` is regularized: small eigenvalues of `S` are
/// mostly noise, and their reciprocals are large.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Regularization {
    /// Inverts the `rank` eigenvalues of largest magnitude and drops the rest (eq. 4): the method of the paper, and the
    /// fastest.
    LowRank {
        /// Number of eigenpairs to keep (`n1`), from 1 to the number of samples n. Default: half of n, at least
        /// `dim + 4`. The smallest rank that is exact for Euclidean distances, `dim + 2`, is too small for some first
        /// samples, and n is too large for most.
        rank: Option<usize>,
    },
    /// Replaces each reciprocal `1 / σ` by `σ / (σ² + α / σ²)`, with the sign of the eigenvalue (eq. 3).
    Rpi {
        /// How strongly small eigenvalues are damped.
        alpha: RpiAlpha,
    },
    /// Inverts all eigenvalues that are not rounding error: the plain Nystrom method.
    None,
    /// The CUR decomposition `Ê = C U R'`, with `C` the columns of the first `rank` samples and `U` the pseudo-inverse of
    /// their rows at the samples (eq. 9). It is not symmetric, so an embedding uses the mean of it and its transpose.
    Cur {
        /// Number of columns in `C` (`n1`), as `rank` of [`Regularization::LowRank`].
        rank: Option<usize>,
    },
}

impl Default for Regularization {
    fn default() -> Self {
        Self::LowRank { rank: None }
    }
}

/// The `α` of [`Regularization::Rpi`].
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RpiAlpha {
    /// `α = c σ1⁴` for this c, which has no unit; `σ1` is the largest magnitude of the eigenvalues. 1e-10 is safe for few
    /// and many samples. With accurate distances and 100 samples, 1e-12 to 1e-14 reconstructs better; below 20 samples,
    /// 1e-8 often embeds better.
    Relative(f64),
    /// `α = σ1³`, the paper's choice after Civril et al. (`civril2007` in `REFERENCES.bib`).
    ///
    /// **The only choice that depends on the unit of length**: `α` is compared with `σ⁴`, so `c = 1 / σ1` with `σ1` in the
    /// squared unit of the distances. With distances in metres it regularizes a million times as strongly as in
    /// millimetres.
    Paper,
}

impl Default for RpiAlpha {
    fn default() -> Self {
        Self::Relative(1e-10)
    }
}

impl std::str::FromStr for RpiAlpha {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.parse() {
            _ if text == "paper" => Ok(Self::Paper),
            Ok(c) => Ok(Self::Relative(c)),
            Err(_) => Err(format!("`{text}` is neither a number nor `paper`")),
        }
    }
}

impl RpiAlpha {
    /// `α / σ1⁴`, which has no unit. `sigma_1` is the largest magnitude of the eigenvalues of `S`, in the squared unit of the
    /// distances.
    pub fn relative(self, sigma_1: f64) -> f64 {
        match self {
            Self::Relative(c) => c,
            Self::Paper => 1.0 / sigma_1,
        }
    }
}

impl Regularization {
    /// All kinds, with their default options.
    pub fn all() -> [Self; 4] {
        [
            Self::LowRank { rank: None },
            Self::Rpi { alpha: RpiAlpha::default() },
            Self::None,
            Self::Cur { rank: None },
        ]
    }

    /// The name on the command line and in records.
    pub fn name(self) -> &'static str {
        self.into()
    }

    /// The number of eigenpairs (for CUR, of columns) used with `n_landmarks` samples to embed in `dim` dimensions: n1, or
    /// n for regularizations that use all.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`], [`NmdsError::BadAlpha`].
    pub fn rank(self, n_landmarks: usize, dim: usize) -> Result<usize, NmdsError> {
        let rank = match self {
            Self::LowRank { rank } | Self::Cur { rank } => {
                rank.unwrap_or((dim + 4).max(n_landmarks.div_ceil(2)).min(n_landmarks))
            }
            Self::None => n_landmarks,
            Self::Rpi { alpha: RpiAlpha::Relative(alpha) } if !(alpha > 0.0 && alpha.is_finite()) => {
                return Err(NmdsError::BadAlpha(alpha));
            }
            Self::Rpi { .. } => n_landmarks,
        };
        if rank == 0 || rank > n_landmarks {
            return Err(NmdsError::BadRank { rank, n_landmarks });
        }
        Ok(rank)
    }

    /// The same, if it allows as many dimensions.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`], [`NmdsError::BadAlpha`] and [`NmdsError::BadDimension`].
    pub fn rank_in(self, n_landmarks: usize, dim: usize) -> Result<usize, NmdsError> {
        let rank = self.rank(n_landmarks, dim)?;
        check_dim(dim, rank)?;
        Ok(rank)
    }

    /// The number of samples that a [search](SampleSearch) in `dim` dimensions begins with: at least the rank, if one is given.
    pub fn first_samples(self, dim: usize) -> usize {
        let first = SampleSearch::first(dim);
        match self {
            Self::LowRank { rank: Some(rank) } | Self::Cur { rank: Some(rank) } => first.max(rank),
            _ => first,
        }
    }

    /// The pseudo-inverse of `sq_block`, the squared distances between samples in units of `unit²`, with the `rank` from
    /// [`Self::rank`].
    pub(crate) fn pseudo_inverse(
        self,
        sq_block: &Matrix,
        unit: f64,
        rank: usize,
    ) -> Result<PseudoInverse, NmdsError> {
        if let Self::Cur { .. } = self {
            let (right, values, left) = thin_svd(&sq_block.columns(0, rank).into_owned())?;
            let n = sq_block.nrows();
            let factors = [left.resize_vertically(n, 0.0), right];
            let reciprocals = values.iter().map(|value| 1.0 / value).collect();
            return Ok(PseudoInverse { basis: Matrix::identity(n, n), factors, values, reciprocals });
        }
        let SymmetricEigen { values, vectors } = largest_magnitudes(sq_block, rank)?;
        let sigma_1 = values[0].abs();
        let reciprocal = |value: &f64| match self {
            // Samples coincide, or there is only one.
            _ if *value == 0.0 => 0.0,
            Self::Rpi { alpha } => {
                let ratio = value / sigma_1;
                ratio.powi(3) / (ratio.powi(4) + alpha.relative(sigma_1 * unit * unit)) / sigma_1
            }
            _ => 1.0 / value,
        };
        let reciprocals = values.iter().map(reciprocal).collect();
        let factors = [(); 2].map(|()| Matrix::identity(values.len(), values.len()));
        Ok(PseudoInverse { basis: vectors, factors, values, reciprocals })
    }
}

/// `S⁺ = T M T'` with the core `M = X D Y'`, so that `Ê = (R T) M (R T)'`.
#[derive(Debug)]
pub(crate) struct PseudoInverse {
    /// `T`, n x m.
    pub(crate) basis: Matrix,
    /// `X` and `Y`, m x r; the same, except for CUR.
    factors: [Matrix; 2],
    /// Eigenvalues or singular values, in descending order of magnitude, and the diagonal of `D`.
    values: Vec<f64>,
    reciprocals: Vec<f64>,
}

impl PseudoInverse {
    /// The pseudo-inverse without the pairs that are [rounding](n_significant); `w` is the triangular factor of the centered `R T`.
    /// At least one pair stays.
    pub(crate) fn without_rounding(self, w: &Matrix, distances: &LandmarkDistances) -> Self {
        let [x, y] = self.factors.each_ref().map(|factor| w * factor);
        let everywhere = x.column_iter().zip(y.column_iter());
        let everywhere = everywhere.map(|(x, y)| x.norm_squared().max(y.norm_squared()));
        let squares = self.values.iter().zip(everywhere).map(|(value, sum)| [value * value, sum]);
        let (n, p) = (distances.n_landmarks(), distances.n_points());
        let rank = n_significant(&self.values, squares, n, p).max(1);
        Self { reciprocals: self.reciprocals.into_iter().take(rank).collect(), ..self }
    }

    /// Number of eigenpairs or singular values used.
    pub(crate) fn rank(&self) -> usize {
        self.reciprocals.len()
    }

    /// `M`, m x m; symmetric except for CUR.
    pub(crate) fn core(&self) -> Matrix {
        let [mut left, right] =
            self.factors.each_ref().map(|factor| factor.columns(0, self.rank()).into_owned());
        left.column_iter_mut().zip(&self.reciprocals).for_each(|(mut column, factor)| column *= *factor);
        left * right.transpose()
    }
}

/// The `rank` eigenpairs of largest magnitude of a symmetric matrix, without those at rounding error; at least one.
///
/// # Errors
/// [`LinalgError::NotConverged`].
pub fn largest_magnitudes(matrix: &Matrix, rank: usize) -> Result<SymmetricEigen, LinalgError> {
    let eigen = symmetric_eigen(matrix)?;
    let mut order: Vec<usize> = (0..eigen.values.len()).collect();
    order.sort_by(|&i, &j| eigen.values[j].abs().total_cmp(&eigen.values[i].abs()));
    order.truncate(rank);
    let first = order[0];
    let floor = matrix.nrows() as f64 * f64::EPSILON * eigen.values[first].abs();
    order.retain(|&i| i == first || eigen.values[i].abs() > floor);
    Ok(eigen.select(&order))
}
