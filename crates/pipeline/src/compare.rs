//! Two shapes side by side.

use descriptors::{
    Alignment, CanonicalForm, MatchOptions, Normalization, PreparedForm, Reflections, match_forms,
};
use serde::Serialize;

use crate::PipelineError;
use crate::forms::MATCHED_POINTS;

/// Forms of unit area closer than this are called the same shape. Between poses of the cats, centaurs
/// and davids of TOSCA the distance is mostly below 0.07, between the animals above 0.1.
const SAME: f64 = 0.08;

/// Sizes that differ by less than this factor are called equal.
const SAME_SIZE: f64 = 1.05;

/// A proper motion this much worse than the best one means that a mirror was needed.
const MIRROR_NEEDED: f64 = 1.5;

/// How two shapes resemble each other, and how far apart they are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What kind of match it is.
    pub kind: MatchKind,
    /// Distance of the aligned forms, in mesh units.
    pub distance: f64,
    /// Distance of the aligned forms once both have unit area: 0 for the same shape at any size.
    pub normalized_distance: f64,
    /// Distance at which [`MatchKind`] stops speaking of one shape, for `normalized_distance`.
    pub same_below: f64,
    /// Size of the second surface over that of the first, by the roots of their areas.
    pub scale: f64,
    /// Whether the best motion reflects.
    pub reflected: bool,
    /// `normalized_distance` when only proper motions are allowed.
    pub unreflected_distance: f64,
    /// Rows of the matrix that turns the first form onto the second.
    pub rotation: [[f64; 3]; 3],
    /// What is added after the rotation, in mesh units.
    pub translation: [f64; 3],
}

/// What kind of match two shapes are, up to pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum MatchKind {
    /// The same shape.
    Same,
    /// The same shape at another size.
    Scaled,
    /// One is the mirror image of the other.
    Mirrored,
    /// Mirrored, and at another size.
    MirroredAndScaled,
    /// Different shapes.
    Different,
}

impl MatchKind {
    fn new(normalized: f64, unreflected: f64, scale: f64) -> Self {
        let mirrored = unreflected > MIRROR_NEEDED * normalized && unreflected > 0.5 * SAME;
        let resized = scale.max(1.0 / scale) > SAME_SIZE;
        match (normalized < SAME, mirrored, resized) {
            (false, _, _) => Self::Different,
            (true, false, false) => Self::Same,
            (true, false, true) => Self::Scaled,
            (true, true, false) => Self::Mirrored,
            (true, true, true) => Self::MirroredAndScaled,
        }
    }
}

/// Aligns two canonical forms, as they are and at unit spread.
///
/// # Errors
/// [`PipelineError::Descriptor`].
pub fn compare_forms(
    a: &CanonicalForm,
    b: &CanonicalForm,
    options: &MatchOptions,
) -> Result<Comparison, PipelineError> {
    let matched = |normalization, options: &MatchOptions| {
        let prepare =
            |form: &CanonicalForm| PreparedForm::new(&form.normalized(normalization), MATCHED_POINTS);
        match_forms(&prepare(a)?, &prepare(b)?, options)
    };
    let raw = matched(Normalization::Raw, options)?;
    let normalized = matched(Normalization::UnitArea, options)?.distance;
    let proper = MatchOptions { reflections: Reflections::Forbid, ..options.clone() };
    let unreflected = matched(Normalization::UnitArea, &proper)?.distance.max(normalized);
    let scale = match (a.area(), b.area()) {
        (Some(a), Some(b)) => (b / a).sqrt(),
        _ => 1.0,
    };
    let Alignment { rotation, translation, reflected } = raw.alignment;
    Ok(Comparison {
        kind: MatchKind::new(normalized, unreflected, scale),
        distance: raw.distance,
        normalized_distance: normalized,
        same_below: SAME,
        scale,
        reflected,
        unreflected_distance: unreflected,
        rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
        translation: translation.into(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_follow_distance_size_and_chirality() {
        assert_eq!(MatchKind::new(0.2, 0.2, 1.0), MatchKind::Different);
        assert_eq!(MatchKind::new(0.01, 0.012, 1.0), MatchKind::Same);
        assert_eq!(MatchKind::new(0.01, 0.012, 0.5), MatchKind::Scaled);
        assert_eq!(MatchKind::new(0.01, 0.2, 1.02), MatchKind::Mirrored);
        assert_eq!(MatchKind::new(0.01, 0.2, 2.0), MatchKind::MirroredAndScaled);
    }
}
