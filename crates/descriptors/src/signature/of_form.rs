//! Signatures of the canonical form: moments, and the distribution and the spectrum of distances.

use linalg::{Matrix, symmetric_eigenvalues};
use nalgebra::Point3;

use super::geodesic_spectrum::magnitudes;
use super::kind::{Signature, SignatureKind};
use super::quantiles::quantiles;
use crate::canonical_form::CanonicalForm;
use crate::error::DescriptorError;

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

/// Points of a form whose distances have a spectrum. Chosen on built-in bodies: with 150, 250 and 700 points, 336 creatures of
/// 84 bodies have an mAP of .856, .873 and .880, and 120 shapes of 24 bodies one of .433, .436 and .425.
const SPECTRUM_POINTS: usize = 250;

/// The spectrum of the square roots of all straight distances between the points of a form, every point weighted by the area
/// around it: the [geodesic spectrum](crate::geodesic_spectrum) with straight lines for surface distances, and what compares
/// forms alone. Distances without their square roots tell bodies of one family apart less well.
///
/// With `a` the shares of the area of 250 evenly spread points `x`, it has the 24 largest eigenvalues of the matrix
/// `√a_i √|x_i - x_j| √a_j`, by the logarithms of their magnitudes, for the surface of unit area.
///
/// * Invariant to bending, rigid motions, mirror images, the order of vertices and, if the form knows its area, scale;
///   changes with the triangulation as the form does.
/// * Cost `O(p)`, and 5 ms for the eigenvalues.
///
/// # Errors
/// [`DescriptorError::Linalg`] if the eigenvalues are not found.
pub fn form_spectrum(form: &CanonicalForm) -> Result<Signature, DescriptorError> {
    let unit = form.area().map_or_else(|| form.spread(), f64::sqrt);
    let few = form.reduced(SPECTRUM_POINTS);
    let (points, weights) = (few.points(), few.weights());
    let n_points = points.len();
    let kernel = Matrix::from_fn(n_points, n_points, |i, j| {
        (weights[i] * weights[j] * (points[i] - points[j]).norm() / unit).sqrt()
    });
    let values = magnitudes(symmetric_eigenvalues(&kernel)?, 0.0);
    let values = values.ok_or(DescriptorError::NoExtent { n_points })?;
    Ok(Signature { kind: SignatureKind::FormSpectrum, values })
}
