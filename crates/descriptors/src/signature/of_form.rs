//! Signatures of the canonical form: moments, and the distribution of distances.

use nalgebra::Point3;

use super::kind::{Signature, SignatureKind};
use super::quantiles::quantiles;
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

/// Number of bins of the histogram.
const BINS: usize = SignatureKind::D2.n_values();

/// The distribution of the distances between two points of the canonical form: the shape distribution D2 of Osada et
/// al. 2002 (`osada2002` in `REFERENCES.bib`), applied to the form so that straight lines stand for surface distances.
///
/// A histogram of 8 bins with equal shares of all pairs, each pair weighted by the product of the areas around its
/// points. The values are the centres of the bins, divided by the square root of the area. All pairs are used;
/// nothing is drawn at random.
///
/// * Invariant to bending, rigid motions, mirror images, the order of vertices and, if the form knows its area, scale;
///   changes with the triangulation as the form does.
/// * Cost `O(p²)` for p points: use a [reduced](CanonicalForm::reduced) form.
pub fn d2_histogram(form: &CanonicalForm) -> Signature {
    let unit = form.area().map_or_else(|| form.spread(), f64::sqrt);
    let points: Vec<_> = form.points().iter().map(|p| p / unit).zip(form.weights()).collect();
    let points = &points;
    let pairs = points
        .iter()
        .enumerate()
        .flat_map(|(i, (p, a))| points[..i].iter().map(move |(q, b)| ((p - q).norm(), *a * *b)));
    Signature { kind: SignatureKind::D2, values: quantiles(pairs, BINS) }
}
