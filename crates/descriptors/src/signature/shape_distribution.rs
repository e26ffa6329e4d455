//! How far the points of a form are from each other.

use super::quantiles::quantiles;
use super::{Signature, SignatureKind};
use crate::CanonicalForm;

/// Bins of the histogram.
pub(super) const BINS: usize = 8;

/// The distribution of the distances between two points of the canonical form: the shape distribution D2 of Osada et
/// al. 2002 (`osada2002` in `REFERENCES.bib`) where straight lines stand for ways on the surface.
///
/// A histogram of 8 bins that hold the same share of all pairs, pairs counted by the product of the areas
/// around their points: the values are the centres of the bins, over the root of the area. All pairs of
/// points take part, nothing is drawn at random.
///
/// * Invariant to bending, rigid motions, mirror images, scale (when the form knows its area) and the order of
///   vertices; changes with the triangulation as the form does.
/// * Cost `O(p² log p)` for p points: meant for a [reduced](CanonicalForm::reduced) form.
#[must_use]
pub fn d2_histogram(form: &CanonicalForm) -> Signature {
    let unit = form.area().map_or_else(|| form.spread(), f64::sqrt);
    let points: Vec<_> = form.points().iter().zip(form.weights()).collect();
    let pairs = points
        .iter()
        .enumerate()
        .flat_map(|(i, (p, a))| points[..i].iter().map(move |(q, b)| ((*p - *q).norm() / unit, *a * *b)));
    Signature { kind: SignatureKind::D2, values: quantiles(pairs.collect(), BINS) }
}
