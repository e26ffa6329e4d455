//! The spectrum of square roots of surface distances.

use linalg::{LandmarkDistances, Matrix, symmetric_eigenvalues, triangular_factor};
use nmds::largest_magnitudes;

use super::kind::{Signature, SignatureKind};
use crate::error::DescriptorError;

/// Number of eigenvalues used.
const EIGENVALUES: usize = SignatureKind::GeodesicSpectrum.n_values();

/// Smaller eigenvalues count as this share of the largest. Those of surfaces are larger: number 24 is about 0.003 of the
/// first. A tolerance of rounding.
const MIN_SHARE: f64 = 1e-4;

/// The spectrum of the square roots of all surface distances, every point weighted by the area around it.
///
/// | symbol | here | shape | meaning |
/// |---|---|---|---|
/// | `R` | `columns` | p x n | square roots of the distances to the samples |
/// | `a` | `masses` | p | shares of the area; `1' a = 1` |
/// | `V Λ V'` | `eigen` | n x n1 | half of the eigenpairs of the rows of `R` at the samples, by magnitude |
///
/// The kernel `√d(x, y)` is approximated by `R V Λ⁻¹ V' R'` as in NMDS (`shamai2015` in `REFERENCES.bib`). With `Q W` the
/// QR decomposition of `√a R V`, its eigenvalues are those of `W Λ⁻¹ W'`. The values are the logarithms of the 24 largest
/// magnitudes, in descending order, for the surface of unit area. Smeets et al. 2012 (`smeets2012`) compare shapes by the
/// spectrum of distances without areas and logarithms. More than 24 eigenvalues depend on the choice of samples: with 40,
/// subdividing a mesh changes the signature nearly as much as another pose does.
///
/// Square roots and logarithms let short distances count: squares are dominated by the longest ones, and their spectrum by
/// the first three eigenvalues, which are the spreads of the canonical form. The power was chosen on bodies of the
/// built-in families, see `docs/decisions/013-signatures.md`.
///
/// * Invariant to isometries (bending, rigid motions, mirror images), scale and the order of vertices. The
///   triangulation and the choice of samples change it by the error of distances and of the approximation.
/// * Changes if parts touch, because shortcuts change distances.
/// * Cost `O(p n²)`. Eigenvalues beyond half of the samples are not approximated; they count as the least.
///
/// # Errors
/// [`DescriptorError::SizeMismatch`] unless there is one mass per point, [`DescriptorError::NoExtent`],
/// [`DescriptorError::Linalg`].
pub fn geodesic_spectrum(
    distances: &LandmarkDistances,
    masses: &[f64],
    area: f64,
) -> Result<Signature, DescriptorError> {
    let p = distances.n_points();
    if masses.len() != p {
        return Err(DescriptorError::SizeMismatch { n_points: p, n_vertices: masses.len() });
    }
    let (unit, total) = (distances.max(), masses.iter().sum::<f64>());
    if !(unit > 0.0 && total > 0.0 && area > 0.0) {
        return Err(DescriptorError::NoExtent { n_points: p });
    }
    let block = distances.sq_block().map(|sq| (sq.sqrt() / unit).sqrt());
    // Nearly as many as NMDS keeps by default in three dimensions.
    let eigen = largest_magnitudes(&block, (block.nrows() / 2).max(7))?;
    let mut columns = distances.to_matrix()?;
    columns.apply(|d| *d = (*d / unit).sqrt());
    let mut columns = columns * &eigen.vectors;
    let roots: Vec<f64> = masses.iter().map(|m| (m / total).sqrt()).collect();
    for column in columns.as_mut_slice().chunks_exact_mut(p) {
        column.iter_mut().zip(&roots).for_each(|(x, root)| *x *= root);
    }
    let triangle = triangular_factor(&columns);
    let inverse =
        Matrix::from_diagonal(&eigen.values.iter().map(|value| 1.0 / value).collect::<Vec<_>>().into());
    let middle = &triangle * inverse * triangle.transpose();
    let spectrum = symmetric_eigenvalues(&((&middle + middle.transpose()) * 0.5))?;
    let offset = 0.5 * (unit.ln() - 0.5 * area.ln());
    let values =
        log_magnitudes(spectrum, EIGENVALUES, offset).ok_or(DescriptorError::NoExtent { n_points: p })?;
    Ok(Signature { kind: SignatureKind::GeodesicSpectrum, values })
}

/// The logarithms of the `n` largest magnitudes of eigenvalues, in descending order, plus `offset`; `None` if all are zero.
pub(crate) fn log_magnitudes(mut spectrum: Vec<f64>, n: usize, offset: f64) -> Option<Vec<f64>> {
    spectrum.iter_mut().for_each(|value| *value = value.abs());
    spectrum.sort_by(|a, b| b.total_cmp(a));
    let largest = spectrum.first().copied().filter(|value| *value > 0.0)?;
    let value = |i: usize| {
        let share = spectrum.get(i).map_or(0.0, |value| value / largest).max(MIN_SHARE);
        (share * largest).ln() + offset
    };
    Some((0..n).map(value).collect())
}
