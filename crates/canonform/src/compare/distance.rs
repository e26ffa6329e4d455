//! How far apart two shapes are, all that is known of them taken together.

use descriptors::{CanonicalForm, FUSED_SIZE, MatchOptions, match_forms};
use serde::Serialize;

use super::forms::prepare_form;
use super::rerank::{combined_distance, form_limit};
use crate::Error;
use crate::form::ShapeDescription;

/// Shapes nearer than this by [`combined_distance`], size left out, are called one shape in two poses.
///
/// Found on the built-in shapes: two poses of one body are up to 1.67 apart, two bodies 7.2 or more, and this is
/// the middle by ratio. On the low-resolution TOSCA meshes two poses are up to 2.66 apart and two bodies 3.68 or
/// more, but for its three people (david, michael, victoria): they differ in their build alone, come as near as
/// 1.26 and are called one shape in all 1,105 pairs.
pub const SAME_BELOW: f64 = 3.5;

/// The distance that orders the answers of a search, with size left out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShapeDistance {
    /// By fused signatures alone; two poses of one body are about 1 apart.
    #[serde(rename = "fused_distance")]
    pub fused: f64,
    /// By signatures and aligned forms, see [`combined_distance`].
    #[serde(rename = "combined_distance")]
    pub combined: f64,
}

impl ShapeDistance {
    /// Measures signatures and aligns forms.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn between(a: &ShapeDescription, b: &ShapeDescription) -> Result<Self, Error> {
        Self::of([(&a.fused, &a.form), (&b.fused, &b.form)])
    }

    /// Aligns forms, and measures fused signatures, as indexes keep them.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn of([a, b]: [(&[f32], &CanonicalForm); 2]) -> Result<Self, Error> {
        let form = match_forms(&prepare_form(a.1)?, &prepare_form(b.1)?, &MatchOptions::default())?.distance;
        Ok(Self::new([a.0, b.0], form))
    }

    /// Of two fused vectors, and the distance of the aligned forms of unit area.
    pub(crate) fn new(vectors: [&[f32]; 2], form: f64) -> Self {
        // Size, where it counts, is the last coordinate.
        let [a, b] = vectors.map(|vector| &vector[..vector.len().min(FUSED_SIZE)]);
        let fused = a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt();
        Self { fused, combined: combined_distance(fused, form) }
    }

    /// Whether it is that of one shape in two poses.
    #[must_use]
    pub fn is_same(&self) -> bool {
        self.combined < SAME_BELOW
    }

    /// The distance of aligned forms below which these signatures are those of one shape; 0 when they are too far
    /// apart by themselves.
    pub(crate) fn form_limit(&self) -> f64 {
        form_limit(self.fused, SAME_BELOW)
    }
}

#[cfg(test)]
mod tests {
    use descriptors::Normalization;
    use mesh::shapes;

    use super::*;
    use crate::{DescribeOptions, Surface, describe};

    #[test]
    fn size_does_not_count_whether_or_not_it_is_in_the_vectors() {
        let small = shapes::torus(24, 12, 2.0, 0.7);
        let mut large = small.clone();
        // A power of two: a torus has many first samples alike, and rounding must not choose another one.
        large.positions.iter_mut().for_each(|p| p.coords *= 4.0);
        for size in [Normalization::UnitArea, Normalization::Raw] {
            let options = DescribeOptions { size, ..DescribeOptions::default() };
            let [a, b] = [&small, &large].map(|mesh| {
                let surface = Surface::new(mesh, &options.form.repair).unwrap();
                describe(&surface, &options).unwrap()
            });
            let distance = ShapeDistance::between(&a, &b).unwrap();
            assert!(distance.combined < 0.01 && distance.is_same(), "{distance:?}");
        }
    }

    #[test]
    fn a_form_at_the_limit_makes_the_distance_at_which_shapes_stop_being_one() {
        let vectors = |far: f32| [vec![0.0; 3], vec![far, 0.0, 0.0]];
        for far in [0.0, 1.0, 3.0] {
            let [a, b] = vectors(far);
            let limit = ShapeDistance::new([&a, &b], 0.0).form_limit();
            assert!(!ShapeDistance::new([&a, &b], limit * 1.001).is_same());
            assert!(ShapeDistance::new([&a, &b], limit * 0.999).is_same());
        }
        let [a, b] = vectors(4.0);
        let apart = ShapeDistance::new([&a, &b], 0.0);
        assert!(!apart.is_same() && apart.form_limit() == 0.0);
    }
}
