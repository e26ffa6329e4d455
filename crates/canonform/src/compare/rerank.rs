//! Nearest shapes in two stages: by fused signatures, then by aligned forms.

use std::borrow::Borrow;

use descriptors::{MatchOptions, PreparedForm, match_forms_within};
use retrieval::{Candidate, Refinement, refine_nearest};

use crate::Error;

/// Root mean square of the distances between aligned forms of two poses of one body, at unit area: see
/// [`SignatureKind::unit`](descriptors::SignatureKind::unit).
pub const FORM_UNIT: f64 = 0.0271;

/// What [`SignatureKind::weight`](descriptors::SignatureKind::weight) is for aligned forms, beside those of all
/// signatures, with one component: a distance has no more.
pub const FORM_WEIGHT: f64 = 0.0097;

/// The distance of two shapes by signatures and forms: `√(fused² + w (form / unit)²)`.
///
/// `fused` is the distance of the fused signatures, in which size counts or not, `form` that of the aligned forms
/// of unit area, `unit` [`FORM_UNIT`] and `w` [`FORM_WEIGHT`]. The aligned form is one part more, the one that takes an
/// alignment.
#[must_use]
pub fn combined_distance(fused: f64, form: f64) -> f64 {
    fused.hypot(form / FORM_UNIT * FORM_WEIGHT.sqrt())
}

/// The largest `form` that takes [`combined_distance`] from `fused` no farther than `limit`.
pub(crate) fn form_limit(fused: f64, limit: f64) -> f64 {
    // Rounding must not give up what lies at the limit.
    (limit.powi(2) - fused.powi(2)).max(0.0).sqrt() * FORM_UNIT / FORM_WEIGHT.sqrt() * (1.0 + 1e-9)
}

/// The `k` shapes nearest to a query by [`combined_distance`], of candidates in ascending order of the distance of their
/// fused signatures, which is what their `bound` says.
///
/// Forms are aligned only as long as the fused distance alone does not rule a candidate out, and an alignment is
/// given up when it cannot come near enough, see [`match_forms_within`]. But for that the result is that of
/// aligning all candidates. `form` gives the [prepared](crate::ShapeDescription::prepare) form of a candidate.
///
/// # Errors
/// [`Error::Descriptor`], and whatever `form` returns.
pub fn rerank<F: Borrow<PreparedForm>>(
    query: &PreparedForm,
    candidates: impl IntoIterator<Item = Candidate>,
    k: usize,
    options: &MatchOptions,
    form: impl Fn(usize) -> Result<F, Error> + Sync,
) -> Result<Refinement, Error> {
    refine_nearest(candidates, k, |candidate, limit| {
        let left = form_limit(candidate.bound, limit);
        let found = match_forms_within(query, form(candidate.index)?.borrow(), options, left)?;
        Ok(found.map(|found| combined_distance(candidate.bound, found.distance)))
    })
}

#[cfg(test)]
mod tests {
    use descriptors::{CanonicalForm, match_forms};
    use nalgebra::Point3;
    use retrieval::Neighbor;

    use super::*;

    /// Spirals that differ by how far they are wound.
    fn forms() -> Vec<PreparedForm> {
        let spiral = |turns: f64| {
            let points: Vec<_> = (0..400)
                .map(|i| f64::from(i) / 400.0)
                .map(|s| Point3::new(3.0 * s, s * (turns * s).cos(), 0.7 * s * (turns * s).sin()))
                .collect();
            let form = CanonicalForm::from_points(points, vec![1.0; 400]).unwrap();
            PreparedForm::new(&form, 200).unwrap()
        };
        (0..30).map(|i| spiral(1.0 + 0.2 * f64::from(i))).collect()
    }

    #[test]
    fn reranking_finds_what_aligning_all_finds() {
        let forms = forms();
        let options = MatchOptions::default();
        for query in [0, 13] {
            // Signatures that are of some use, and such as say nothing at all.
            for usefulness in [1.0, 0.0] {
                let fused = |i: usize| usefulness * 0.05 * (i.abs_diff(query) as f64 + 2.0 * (i % 3) as f64);
                let mut candidates: Vec<_> =
                    (0..forms.len()).map(|index| Candidate { index, bound: fused(index) }).collect();
                candidates.sort_by(|a, b| a.bound.total_cmp(&b.bound));
                let mut all: Vec<_> = (0..forms.len())
                    .map(|index| {
                        let form = match_forms(&forms[query], &forms[index], &options).unwrap().distance;
                        Neighbor { index, distance: combined_distance(fused(index), form) }
                    })
                    .collect();
                all.sort_by(|a, b| a.distance.total_cmp(&b.distance).then(a.index.cmp(&b.index)));
                for k in [1, 5, 30] {
                    let form = |i: usize| Ok(&forms[i]);
                    let found = rerank(&forms[query], candidates.clone(), k, &options, form).unwrap();
                    assert_eq!(found.nearest, all[..k], "{query}, {k}");
                    assert!(k < 30 || found.abandoned == 0, "nothing can be given up");
                    assert!(k == 30 || found.asked - found.abandoned < 30);
                }
            }
        }
    }
}
