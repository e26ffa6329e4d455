//! The spectrum of squared surface distances.

use linalg::{LandmarkDistances, Matrix, symmetric_eigen, thin_qr};

use super::kind::{Signature, SignatureKind};
use crate::error::DescriptorError;

/// Number of largest eigenvalues used: the dimensions of the best Euclidean embedding.
const POSITIVE: usize = SignatureKind::GeodesicSpectrum.n_values() - NEGATIVE;

/// Number of most negative eigenvalues used: they tell how far the distances are from Euclidean ones.
const NEGATIVE: usize = 4;

/// The spectrum of the matrix that classical scaling decomposes, `-1/2 J E J` with `E` the squared distances on the
/// surface, every point weighted by the area around it.
///
/// | symbol | here | shape | meaning |
/// |---|---|---|---|
/// | `R` | `distances` | p x n | squared distances to the samples |
/// | `a` | `masses` | p | shares of the area; `1' a = 1` |
/// | `V Λ V'` | `eigen` | n x n1 | half of the eigenpairs of the rows of `R` at the samples, by magnitude |
///
/// `E` is approximated by `R V Λ⁻¹ V' R'` as in NMDS (`shamai2015` in `REFERENCES.bib`). With `Q W` the QR decomposition
/// of `√a (I - 1 a') R V`, the eigenvalues are those of `-1/2 W Λ⁻¹ W'`. The values are the square roots of the 8
/// largest and of the magnitudes of the 4 most negative eigenvalues, divided by the square root of the area; the
/// first three are the spreads of the canonical form along its axes. Smeets et al. 2012 (`smeets2012`) compare shapes
/// by this spectrum without areas.
///
/// * Invariant to isometries (bending, rigid motions, mirror images), scale and the order of vertices. The
///   triangulation and the choice of samples change it by the error of distances and of the approximation.
/// * Changes if parts touch, because shortcuts change distances.
/// * Cost `O(p n²)`.
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
    let eigen = symmetric_eigen(&(distances.sq_block() / (unit * unit)))?;
    let kept = strongest(&eigen.values);
    let eigen = eigen.select(&kept);
    let mut columns = distances.to_matrix()?;
    columns.apply(|d| *d = (*d / unit).powi(2));
    let mut columns = columns * &eigen.vectors;
    for mut column in columns.column_iter_mut() {
        let mean = column.iter().zip(masses).map(|(x, m)| x * m).sum::<f64>() / total;
        column.iter_mut().zip(masses).for_each(|(x, m)| *x = (*x - mean) * (m / total).sqrt());
    }
    let triangle = match columns.nrows() >= columns.ncols() {
        true => thin_qr(&columns).1,
        false => columns,
    };
    let inverse =
        Matrix::from_diagonal(&eigen.values.iter().map(|value| -0.5 / value).collect::<Vec<_>>().into());
    let middle = &triangle * inverse * triangle.transpose();
    let spectrum = symmetric_eigen(&((&middle + middle.transpose()) * 0.5))?.values;
    let root = |value: Option<&f64>, sign: f64| {
        value.map_or(0.0, |value| (sign * value).max(0.0).sqrt() * unit / area.sqrt())
    };
    let positive = (0..POSITIVE).map(|i| root(spectrum.get(i), 1.0));
    let negative = (0..NEGATIVE).map(|i| root(spectrum.iter().rev().nth(i), -1.0));
    Ok(Signature { kind: SignatureKind::GeodesicSpectrum, values: positive.chain(negative).collect() })
}

/// The half of the eigenvalues of largest magnitude, without those that are rounding errors.
fn strongest(values: &[f64]) -> Vec<usize> {
    let n = values.len();
    let largest = values.iter().fold(0.0, |a: f64, x| a.max(x.abs()));
    let floor = n as f64 * f64::EPSILON * largest;
    let mut order: Vec<usize> = (0..n).filter(|&i| values[i].abs() > floor).collect();
    order.sort_by(|&i, &j| values[j].abs().total_cmp(&values[i].abs()));
    // The least number that is exact for Euclidean distances, see NMDS.
    order.truncate((n / 2).max(7));
    order
}
