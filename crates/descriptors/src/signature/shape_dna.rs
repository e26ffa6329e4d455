//! ShapeDNA.

use std::f64::consts::PI;

use super::kind::{Signature, SignatureKind};
use crate::spectrum::LaplaceSpectrum;

/// Number of eigenvalues used.
const LENGTH: usize = SignatureKind::ShapeDna.n_values();

/// ShapeDNA: the eigenvalues of the Laplace-Beltrami operator (Reuter, Wolter and Peinecke 2006,
/// `reuter2006` in `REFERENCES.bib`).
///
/// The values are `λ_i A / (4 π i)` for the first 20 eigenvalues after zero, with `A` the area. By Weyl's law `λ_i A` grows
/// like `4 π i`, so all values are near one and none dominates.
///
/// * Invariant to isometries (bending, rigid motions, mirror images) and scale. The triangulation changes them by the
///   error of linear finite elements.
/// * If a mesh has fewer eigenvalues, the remaining values are one.
#[must_use]
pub fn shape_dna(spectrum: &LaplaceSpectrum) -> Signature {
    let value = |i: usize| spectrum.values.get(i).map_or(1.0, |value| value / (4.0 * PI * i as f64));
    Signature { kind: SignatureKind::ShapeDna, values: (1..=LENGTH).map(value).collect() }
}
