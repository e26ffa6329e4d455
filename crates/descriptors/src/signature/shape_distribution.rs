//! The distribution of distances within a form.

use super::kind::{Signature, SignatureKind};
use super::quantiles::quantiles;
use crate::canonical_form::CanonicalForm;

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
/// * Cost `O(p² log p)` for p points: use a [reduced](CanonicalForm::reduced) form.
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
