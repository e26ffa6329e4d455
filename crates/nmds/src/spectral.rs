//! Spectral multidimensional scaling.

use linalg::{LandmarkDistances, Matrix, thin_qr};

use crate::squares::{center_columns, check_dim, check_extent, check_points, symmetrized};
use crate::{Embedding, NmdsError};

/// The smallest eigenpairs of a Laplacian, `W Φ = A Φ Λ`.
#[derive(Debug, Clone, Copy)]
pub struct SpectralBasis<'a> {
    /// The eigenvalues, ascending from zero.
    pub values: &'a [f64],
    /// The eigenvectors as columns, p x m, with `Φ' A Φ = I`.
    pub vectors: &'a Matrix,
    /// The diagonal of `A`: the area of each of the p points.
    pub masses: &'a [f64],
}

impl SpectralBasis<'_> {
    /// The default weight of distances. With 10 to 200 samples and 300 eigenvectors, the stress is within 0.2 % of that of the best
    /// weight, which is infinite. With nearly as many samples as eigenvectors an infinite weight fits noise, while this one stays
    /// within 3 % of the optimum.
    pub const MU: f64 = 1e3;
}

/// Eigenvalues up to this are zero up to rounding, for a surface of unit area.
const KERNEL: f64 = 1e-10;

/// Spectral multidimensional scaling (SMDS): embeds p points from the distances between n of them,
/// interpolated as smoothly as the surface allows.
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `Φ`, `Λ` | `basis` | p x m, m | smallest eigenpairs of the Laplace-Beltrami operator |
/// | `D` | `S` | n x n | squared distances between the samples |
/// | `M` | | m x n | `(Λ + mu Φ_s' Φ_s)^-1 mu Φ_s'`, `Φ_s` the rows of `Φ` at the samples |
/// | `α` | `M S M'` | m x m | squared distances in the basis |
/// | | `P = Φ M` | p x n | interpolates a function given at the samples |
///
/// `Z = Q U √L` with the `k` algebraically largest eigenpairs `U L U'` of `-1/2 W S W'`, `Q W = J P`: classical
/// scaling of `P S P' = Φ α Φ'` (Aflalo and Kimmel 2013, [`aflalo2013`] in `REFERENCES.bib`; the separable
/// solution of their published code).
///
/// * `mu` weighs the known distances against smoothness on a surface of unit area. If it is infinite, the distances are fitted first
///   (exactly if there are at least as many eigenvectors as samples), and smoothness decides the rest.
/// * Uses the distances between samples only.
/// * Independent of the unit of length.
/// * `M` is computed from an n x n system that is well conditioned for any `mu`, even infinite: off the kernel
///   `M = Λ^-1 Φ_s' C`, where `(Φ_s Λ^-1 Φ_s' + I / mu) C = I` up to functions in the kernel.
/// * Cost: `O(p n (m + n))` time besides the basis, `O(p n)` memory.
///
/// # Errors
/// [`NmdsError::PointMismatch`], [`NmdsError::BadSmoothness`], [`NmdsError::NotDetermined`],
/// [`NmdsError::BadDimension`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
///
/// # Panics
/// If the numbers of eigenvalues and eigenvectors differ.
///
/// [`aflalo2013`]: https://doi.org/10.1073/pnas.1308708110
pub fn spectral(
    distances: &LandmarkDistances,
    basis: &SpectralBasis<'_>,
    mu: f64,
    dim: usize,
) -> Result<Embedding, NmdsError> {
    let (p, m) = basis.vectors.shape();
    assert_eq!(basis.values.len(), m, "one eigenvalue per eigenvector");
    check_points(p, distances.n_points())?;
    check_points(basis.masses.len(), distances.n_points())?;
    // The constant function spans no dimension.
    check_dim(dim, distances.n_landmarks().min(m.saturating_sub(1)))?;
    if mu.is_nan() || mu <= 0.0 {
        return Err(NmdsError::BadSmoothness(mu));
    }
    let unit = check_extent(distances.max(), distances.n_points())?;
    let mut interpolant = interpolant(distances.landmarks(), basis, mu)?;
    center_columns(&mut interpolant);
    let (q, w) = thin_qr(&interpolant);
    let inner = symmetrized(&w * (distances.sq_block() / (-2.0 * unit * unit)) * w.transpose());
    Embedding::from_factors(q, &inner, dim, unit, distances.n_landmarks())
}

/// `P = Φ M`: column j is the smoothest function that is one at sample j and zero at the others, as closely as `mu`
/// demands and the basis allows.
fn interpolant(samples: &[usize], basis: &SpectralBasis<'_>, mu: f64) -> Result<Matrix, NmdsError> {
    let area: f64 = basis.masses.iter().sum();
    // Normalizes to unit area: eigenvalues times the area, eigenvectors times its root.
    let values: Vec<f64> = basis.values.iter().map(|value| value * area).collect();
    let at_samples = basis.vectors.select_rows(samples) * area.sqrt();
    let coefficients = match mu.is_infinite() && samples.len() >= values.len() {
        true => least_squares(&at_samples),
        false => smoothest(&at_samples, &values, mu),
    };
    let found = coefficients.filter(|m| m.iter().all(|x| x.is_finite()));
    let coefficients = found.ok_or(NmdsError::NotDetermined(samples.len()))?;
    Ok(basis.vectors * coefficients * area.sqrt())
}

/// `M` for a finite `mu`, or its limit if there are more eigenvectors than samples. `None` if a function in the kernel is
/// zero at all samples.
fn smoothest(at_samples: &Matrix, values: &[f64], mu: f64) -> Option<Matrix> {
    let (n, m) = at_samples.shape();
    let kernel = values.iter().take_while(|value| **value <= KERNEL).count();
    let (null, curved) = (at_samples.columns(0, kernel), at_samples.columns(kernel, m - kernel));
    let mut filtered = curved.transpose();
    for (mut row, value) in filtered.row_iter_mut().zip(&values[kernel..]) {
        row /= *value;
    }
    let mut system = curved * &filtered;
    for i in 0..n {
        system[(i, i)] += 1.0 / mu;
    }
    let [weights, constants] = solve_saddle_point(&system, &null.into_owned())?;
    let mut coefficients = Matrix::zeros(m, n);
    coefficients.rows_mut(0, kernel).copy_from(&constants);
    coefficients.rows_mut(kernel, m - kernel).copy_from(&(filtered * weights));
    Some(coefficients)
}

/// `M` for an infinite `mu` if there are at most as many eigenvectors as samples. `None` if the samples do not distinguish
/// them.
fn least_squares(at_samples: &Matrix) -> Option<Matrix> {
    let (q, r) = thin_qr(at_samples);
    r.solve_upper_triangular(&q.transpose())
}

/// The blocks `X` and `Y` of the solution of `[A N; N' 0] [X; Y] = [I; 0]`; `None` if the system is singular.
fn solve_saddle_point(a: &Matrix, null: &Matrix) -> Option<[Matrix; 2]> {
    let (n, m) = null.shape();
    let mut system = Matrix::zeros(n + m, n + m);
    system.view_mut((0, 0), (n, n)).copy_from(a);
    system.view_mut((0, n), (n, m)).copy_from(null);
    system.view_mut((n, 0), (m, n)).copy_from(&null.transpose());
    let solution = system.lu().solve(&Matrix::identity(n + m, n))?;
    let is_finite = solution.iter().all(|x| x.is_finite());
    is_finite.then(|| [solution.rows(0, n).into_owned(), solution.rows(n, m).into_owned()])
}
