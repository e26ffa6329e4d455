//! Kernel PCA with the Nystrom method, the baseline of the NMDS paper.

use linalg::{LandmarkDistances, Matrix, symmetric_eigen, thin_qr};

use crate::squares::{center_columns, check_extent, n_significant, positive_pairs};
use crate::{Embedding, NmdsError, Regularization};

/// The width `sigma` of the Gaussian kernel `exp(-d^2 / (2 sigma^2))`.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Bandwidth {
    /// The mean distance between landmarks and points, as in Liu, Jain and Zhang.
    #[default]
    Mean,
    /// The median of these distances.
    Median,
    /// The maximum of these distances: the kernel is then nearly linear in the squared distance.
    Max,
    /// This width, in the unit of the distances.
    Value(f64),
}

impl std::str::FromStr for Bandwidth {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.parse()) {
            ("mean", _) => Ok(Self::Mean),
            ("median", _) => Ok(Self::Median),
            ("max", _) => Ok(Self::Max),
            (_, Ok(sigma)) => Ok(Self::Value(sigma)),
            (_, Err(_)) => Err(format!("`{text}` is neither a number nor `mean`, `median` or `max`")),
        }
    }
}

impl Bandwidth {
    fn sigma(self, distances: &Matrix) -> Result<f64, NmdsError> {
        let values = distances.as_slice();
        let sigma = match self {
            Self::Mean => values.iter().sum::<f64>() / values.len().max(1) as f64,
            Self::Median => {
                let mut sorted = values.to_vec();
                let middle = sorted.len() / 2;
                *sorted.select_nth_unstable_by(middle, f64::total_cmp).1
            }
            Self::Max => values.iter().copied().fold(0.0, f64::max),
            Self::Value(sigma) => sigma,
        };
        if sigma > 0.0 && sigma.is_finite() { Ok(sigma) } else { Err(NmdsError::BadBandwidth(sigma)) }
    }
}

/// Kernel PCA of geodesic distances with a Gaussian kernel, extrapolated from n landmarks.
///
/// | symbol | here | shape | meaning |
/// |---|---|---|---|
/// | `K` | `kernel` | p x n | `exp(-d^2 / (2 sigma^2))` |
/// | `U L U'` | `kept` | n x n1 | leading eigenpairs of its rows at the landmarks |
/// | `Phi` | result | p x k | principal components of the centered kernel `K U L^-1 U' K'` |
///
/// * `rank` eigenpairs of the sample kernel are kept, by default half of n, at least `dim + 4`, as in NMDS.
/// * The kernel is centered over all p points, which removes the constant leading vector. Components are scaled by the
///   roots of their eigenvalues and have no unit.
/// * Cost: `O(p n n1)` time, `O(p n)` memory.
///
/// After Liu, Jain and Zhang 2006 (`liu2006` in `REFERENCES.bib`).
///
/// # Errors
/// [`NmdsError::BadBandwidth`], [`NmdsError::BadRank`], [`NmdsError::BadDimension`],
/// [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
pub fn kernel_pca(
    distances: &LandmarkDistances,
    bandwidth: Bandwidth,
    rank: Option<usize>,
    dim: usize,
) -> Result<Embedding, NmdsError> {
    let rank = Regularization::LowRank { rank }.rank_in(distances.n_landmarks(), dim)?;
    check_extent(distances.max(), distances.n_points())?;
    let mut kernel = distances.to_matrix()?;
    let sigma = bandwidth.sigma(&kernel)?;
    let gauss = |sq: f64| (-0.5 * sq / (sigma * sigma)).exp();
    kernel.apply(|d| *d = gauss(*d * *d));
    let block = distances.sq_block().map(gauss);

    let eigen = symmetric_eigen(&block)?;
    // A Gaussian of geodesic distances may be indefinite.
    let kept = positive_pairs(&eigen, rank);
    let mut columns = kernel * &kept.vectors;
    for (mut column, value) in columns.column_iter_mut().zip(&kept.values) {
        column /= value.sqrt();
    }
    let squares =
        kept.values.iter().zip(columns.column_iter()).map(|(value, column)| [*value, column.norm_squared()]);
    let rank = n_significant(&kept.values, squares, block.nrows(), columns.nrows());
    let mut columns = columns.resize_horizontally(rank, 0.0);
    center_columns(&mut columns);
    let (q, w) = thin_qr(&columns);
    Embedding::from_factors(q, &(&w * w.transpose()), dim, 1.0, rank)
}
