//! Moments of the canonical form.

use nalgebra::Point3;

use super::kind::{Signature, SignatureKind};
use crate::canonical_form::CanonicalForm;

/// Exponents `(p, q, r)` of the moments: second order along the axes, and all of third order.
const EXPONENTS: [[i32; 3]; LENGTH] = [
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [3, 0, 0],
    [0, 3, 0],
    [0, 0, 3],
    [2, 1, 0],
    [2, 0, 1],
    [1, 2, 0],
    [0, 2, 1],
    [1, 0, 2],
    [0, 1, 2],
    [1, 1, 1],
];

/// Number of values of [`moment_signature`].
const LENGTH: usize = SignatureKind::Moments.n_values();

/// Moments of the canonical form in its principal axes (Elad and Kimmel 2003, `elad2003` in `REFERENCES.bib`).
///
/// `μ_pqr = Σ_i a_i x_i^p y_i^q z_i^r`, with `a` the shares of the area and lengths divided by the square root of the
/// area. The values are `|μ_pqr|^(1 / (p + q + r))`, which scale like a length: second order along the axes, and all of
/// third order. The magnitude removes the arbitrary signs of the axes.
///
/// * Invariant to bending, rigid motions, mirror images, the order of vertices and, if the form knows its area, scale;
///   changes with the triangulation as the form does.
/// * **Not continuous** where two axes have the same spread, because their order is then arbitrary.
#[must_use]
pub fn moment_signature(form: &CanonicalForm) -> Signature {
    let unit = form.area().map_or_else(|| form.spread(), f64::sqrt);
    let (axes, _) = form.principal_axes();
    let turned: Vec<Point3<f64>> = form.points().iter().map(|p| axes * p / unit).collect();
    let moment = |exponents: [i32; 3]| {
        let at = |p: &Point3<f64>| (0..3).map(|axis| p[axis].powi(exponents[axis])).product::<f64>();
        let sum: f64 = turned.iter().zip(form.weights()).map(|(p, w)| w * at(p)).sum();
        sum.abs().powf(1.0 / f64::from(exponents.iter().sum::<i32>()))
    };
    Signature { kind: SignatureKind::Moments, values: EXPONENTS.map(moment).to_vec() }
}
