//! Two shapes side by side.

use descriptors::{
    Alignment, CanonicalForm, FormMatch, MatchOptions, Normalization, PreparedForm, Reflections, match_forms,
};
use nalgebra::Point3;
use serde::Serialize;

use super::distance::ShapeDistance;
use super::forms::MATCHED_POINTS;
use super::handedness::{Handedness, OutwardForm, handedness};
use crate::Error;
use crate::input::Surface;

/// Forms of unit area closer than this fit: they may be those of one shape, which takes a [`ShapeDistance`] to say, and
/// their surfaces can be held against each other. Between poses of the cats, centaurs and davids of TOSCA the
/// distance is mostly below 0.07, between them mostly above 0.1, but a cat and a dog may be 0.06 apart.
const FITTING: f64 = 0.08;

/// Sizes that differ by less than this factor are called equal.
const SAME_SIZE: f64 = 1.05;

/// How two shapes resemble each other, and how far apart they are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// What kind of match it is.
    pub kind: MatchKind,
    /// Distance of the aligned forms, in mesh units.
    pub distance: f64,
    /// Distance of the aligned forms once both have unit area: 0 for the same shape at any size.
    pub normalized_distance: f64,
    /// Distance at which [`MatchKind`] stops speaking of one shape, for `normalized_distance`; 0 when signatures
    /// alone tell the shapes apart.
    pub same_below: f64,
    /// How far apart the shapes are by all that is known of them, which decides on `kind`.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub shape_distance: Option<ShapeDistance>,
    /// Size of the second surface over that of the first, by the roots of their areas.
    pub scale: f64,
    /// Whether the best motion reflects.
    pub reflected: bool,
    /// `normalized_distance` when only proper motions are allowed.
    pub unreflected_distance: f64,
    /// Whether one is the mirror image of the other. Forms cannot tell: distances on a surface and on its mirror image
    /// are the same, and the sign of every axis is left to chance. It takes the two surfaces.
    pub handedness: Handedness,
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
    fn new(is_same: bool, handedness: Handedness, scale: f64) -> Self {
        let mirrored = handedness == Handedness::Mirrored;
        let resized = scale.max(1.0 / scale) > SAME_SIZE;
        match (is_same, mirrored, resized) {
            (false, _, _) => Self::Different,
            (true, false, false) => Self::Same,
            (true, false, true) => Self::Scaled,
            (true, true, false) => Self::Mirrored,
            (true, true, true) => Self::MirroredAndScaled,
        }
    }
}

impl Comparison {
    /// The same comparison with its kind decided by signatures and forms together, as a search orders its answers.
    #[must_use]
    pub fn decided_by(self, distance: ShapeDistance) -> Self {
        Self {
            kind: MatchKind::new(distance.is_same(), self.handedness, self.scale),
            same_below: distance.form_limit(),
            shape_distance: Some(distance),
            ..self
        }
    }
}

/// Aligns two canonical forms, as they are and at unit area. The kind of match is decided by their fit alone, which
/// also different shapes may have: see [`Comparison::decided_by`]. Forms do not tell a shape from its mirror image: see
/// [`compare_surfaces`].
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare_forms(
    a: &CanonicalForm,
    b: &CanonicalForm,
    options: &MatchOptions,
) -> Result<Comparison, Error> {
    Ok(Compared::new([a, b], options)?.comparison)
}

/// A comparison of two forms, and what it was made from.
struct Compared {
    comparison: Comparison,
    /// The forms at unit area.
    units: [CanonicalForm; 2],
    prepared: [PreparedForm; 2],
    /// How the first of them matches the second, and how it does by proper motions alone.
    best: FormMatch,
    proper: FormMatch,
}

impl Compared {
    fn new([a, b]: [&CanonicalForm; 2], options: &MatchOptions) -> Result<Self, Error> {
        let raw = match_forms(
            &PreparedForm::new(a, MATCHED_POINTS)?,
            &PreparedForm::new(b, MATCHED_POINTS)?,
            options,
        )?;
        let units = [a, b].map(|form| form.normalized(Normalization::UnitArea));
        let prepared =
            [PreparedForm::new(&units[0], MATCHED_POINTS)?, PreparedForm::new(&units[1], MATCHED_POINTS)?];
        let best = match_forms(&prepared[0], &prepared[1], options)?;
        let proper = MatchOptions { reflections: Reflections::Forbid, ..options.clone() };
        let proper = match_forms(&prepared[0], &prepared[1], &proper)?;
        let scale = match (a.area(), b.area()) {
            (Some(a), Some(b)) => (b / a).sqrt(),
            _ => 1.0,
        };
        let Alignment { rotation, translation, reflected } = raw.alignment;
        let comparison = Comparison {
            kind: MatchKind::new(best.distance < FITTING, Handedness::Unknown, scale),
            distance: raw.distance,
            normalized_distance: best.distance,
            same_below: FITTING,
            shape_distance: None,
            scale,
            reflected,
            unreflected_distance: proper.distance.max(best.distance),
            handedness: Handedness::Unknown,
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
            translation: translation.into(),
        };
        Ok(Self { comparison, units, prepared, best, proper })
    }

    /// The forms laid over each other by a motion of the first one of unit area, at this size.
    fn overlay(&self, motion: &Alignment, size: f64) -> Overlay {
        let [(a, of_a), (b, of_b)] = [0, 1].map(|i| (self.units[i].points(), &self.prepared[i]));
        let back = motion.inverse();
        Overlay {
            points: [
                a.iter().map(|p| motion.apply(p) * size).collect(),
                b.iter().map(|p| p * size).collect(),
            ],
            residuals: [
                a.iter().map(|p| of_b.nearest_to(&motion.apply(p)).1 * size).collect(),
                b.iter().map(|p| of_a.nearest_to(&back.apply(p)).1 * size).collect(),
            ],
        }
    }
}

/// Whether two meshes are the same triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Triangulation {
    /// The same faces over the same vertex numbers: one mesh in two poses.
    Same,
    /// Others, or others' numbers: at least one of the two was meshed anew.
    Other,
}

/// What two surfaces are to each other, beyond what their forms say.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceComparison {
    /// What the forms say, and the handedness.
    pub comparison: Comparison,
    /// Whether the meshes are one.
    pub triangulation: Triangulation,
    /// The two forms laid over each other.
    pub overlay: Overlay,
}

/// Two forms laid over each other, both of the first one's size, in units of the first mesh and where the second
/// one is.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// The points of either form.
    pub points: [Vec<Point3<f64>>; 2],
    /// For every point of either form how far it is from the nearest point of the other.
    pub residuals: [Vec<f64>; 2],
}

/// Compares two forms as [`compare_forms`] does, and lays them over each other.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn overlay_forms(
    [a, b]: [&CanonicalForm; 2],
    options: &MatchOptions,
) -> Result<(Comparison, Overlay), Error> {
    let compared = Compared::new([a, b], options)?;
    let overlay = compared.overlay(&compared.best.alignment, size_of(a));
    Ok((compared.comparison, overlay))
}

/// Root of the area of the surface; 1 where that is not known.
fn size_of(form: &CanonicalForm) -> f64 {
    form.area().map_or(1.0, f64::sqrt)
}

/// Compares two surfaces by their forms, which must be of all their vertices: what kind of match they are, and where
/// they differ.
///
/// Which of two mirror images a surface is, its distances do not say. It is found by carrying the outside of
/// the first surface over to the second by the nearest points of the aligned forms: a map that fits and turns
/// inside out means a mirror image. That takes surfaces with an inside, and bodies whose left differs from
/// their right.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare_surfaces(
    [a, b]: [&Surface; 2],
    [form_a, form_b]: [&CanonicalForm; 2],
    options: &MatchOptions,
) -> Result<SurfaceComparison, Error> {
    let compared = Compared::new([form_a, form_b], options)?;
    let [from, onto] = &compared.prepared;
    let reflecting = MatchOptions { reflections: Reflections::Require, ..options.clone() };
    let reflected = match_forms(from, onto, &reflecting)?;
    let found = [&compared.proper, &reflected].map(|found| (found.distance, found.alignment));
    let outward = [(&compared.units[0], a), (&compared.units[1], b)]
        .map(|(form, surface)| OutwardForm::new(form, surface.mesh()));
    let mut comparison = compared.comparison.clone();
    if let ([Some(a), Some(b)], true) = (&outward, comparison.normalized_distance < FITTING) {
        comparison.handedness = handedness(a, b, onto, found);
        comparison.kind = MatchKind::new(true, comparison.handedness, comparison.scale);
    }
    let best = if found[1].0 < found[0].0 { found[1].1 } else { found[0].1 };
    let same = a.input_faces == b.input_faces && a.n_input_vertices() == b.n_input_vertices();
    Ok(SurfaceComparison {
        comparison,
        triangulation: if same { Triangulation::Same } else { Triangulation::Other },
        overlay: compared.overlay(&best, size_of(form_a)),
    })
}

#[cfg(test)]
mod tests {
    use mesh::{RepairOptions, TriMesh, shapes};

    use super::*;
    use crate::{DescribeOptions, FormOptions, describe, embed};

    #[test]
    fn kinds_follow_distance_size_and_handedness() {
        let kind = MatchKind::new;
        assert_eq!(kind(false, Handedness::Mirrored, 1.0), MatchKind::Different);
        for unclear in [Handedness::Same, Handedness::Either, Handedness::Unknown] {
            assert_eq!(kind(true, unclear, 1.0), MatchKind::Same);
            assert_eq!(kind(true, unclear, 0.5), MatchKind::Scaled);
        }
        assert_eq!(kind(true, Handedness::Mirrored, 1.02), MatchKind::Mirrored);
        assert_eq!(kind(true, Handedness::Mirrored, 2.0), MatchKind::MirroredAndScaled);
    }

    /// A ball with arms of these lengths towards the corners of a tetrahedron: one hand, or the other.
    fn four_arms(lengths: [f64; 4]) -> TriMesh {
        let corners = [[1.0, 1.0, 1.0], [1.0, -1.0, -1.0], [-1.0, 1.0, -1.0], [-1.0, -1.0, 1.0]];
        let mut mesh = shapes::icosphere(4);
        for p in &mut mesh.positions {
            let direction = p.coords;
            for (corner, length) in corners.iter().zip(lengths) {
                let towards = direction.dot(&nalgebra::Vector3::from(*corner)) / 3f64.sqrt();
                p.coords += direction * length * (-(1.0 - towards) * 12.0).exp();
            }
        }
        mesh
    }

    fn compared(a: &TriMesh, b: &TriMesh) -> SurfaceComparison {
        let options = FormOptions::default();
        let [a, b] = [a, b].map(|mesh| {
            let surface = Surface::new(mesh, &RepairOptions::default()).unwrap();
            let form = embed(&surface, &options, &()).unwrap().form(&surface).unwrap();
            (surface, form)
        });
        compare_surfaces([&a.0, &b.0], [&a.1, &b.1], &MatchOptions::default()).unwrap()
    }

    #[test]
    fn mirror_images_are_told_from_shapes_and_sizes() {
        let hand = four_arms([1.0, 1.7, 2.6, 3.5]);
        // Reflected as by a mirror: positions, and faces so that outside stays outside.
        let mut other = hand.clone();
        other.positions.iter_mut().for_each(|p| p.x = -p.x);
        let inside_out = other.clone();
        other.faces.iter_mut().for_each(|face| face.swap(1, 2));
        let mut large = other.clone();
        large.positions.iter_mut().for_each(|p| p.coords *= 3.0);
        let found = compared(&hand, &hand);
        assert_eq!((found.comparison.kind, found.triangulation), (MatchKind::Same, Triangulation::Same));
        assert_eq!(found.comparison.handedness, Handedness::Same);
        assert!(found.overlay.residuals.iter().flatten().all(|r| *r < 1e-9));
        for mirrored in [&other, &inside_out] {
            let found = compared(&hand, mirrored);
            assert_eq!(found.comparison.kind, MatchKind::Mirrored, "{:?}", found.comparison);
        }
        let found = compared(&hand, &large);
        assert_eq!(found.comparison.kind, MatchKind::MirroredAndScaled);
        assert_eq!(found.triangulation, Triangulation::Other, "faces run the other way round");
        let ball = shapes::icosphere(3);
        assert_eq!(compared(&ball, &ball).comparison.handedness, Handedness::Either);
        let sheet = shapes::grid(12, 9, 0.1);
        assert_eq!(compared(&sheet, &sheet).comparison.handedness, Handedness::Unknown);
    }

    #[test]
    fn signatures_and_forms_together_decide_on_the_kind() {
        let (hand, ball) = (four_arms([1.0, 1.7, 2.6, 3.5]), shapes::icosphere(3));
        let mut large = hand.clone();
        large.positions.iter_mut().for_each(|p| p.coords *= 2.0);
        for (other, kind) in [(&large, MatchKind::Scaled), (&ball, MatchKind::Different)] {
            let [a, b] = [&hand, other].map(|mesh| {
                let surface = Surface::new(mesh, &RepairOptions::default()).unwrap();
                describe(&surface, &DescribeOptions::default()).unwrap()
            });
            let distance = ShapeDistance::between(&a, &b).unwrap();
            let by_forms = compare_forms(&a.form, &b.form, &MatchOptions::default()).unwrap();
            let found = by_forms.clone().decided_by(distance);
            assert_eq!((found.kind, found.shape_distance), (kind, Some(distance)));
            assert_eq!(found.normalized_distance < found.same_below, kind != MatchKind::Different);
            // A fit of forms makes no shape of two.
            let apart = ShapeDistance { fused: 9.0, combined: 9.0 };
            assert_eq!(by_forms.decided_by(apart).kind, MatchKind::Different);
        }
    }

    #[test]
    fn residuals_are_distances_to_the_other_form_as_it_is_laid_over() {
        let (hand, changed) = (four_arms([1.0, 1.7, 2.6, 3.5]), four_arms([1.0, 1.4, 2.6, 3.1]));
        let mut large = changed.clone();
        large.positions.iter_mut().for_each(|p| p.coords *= 5.0);
        let options = FormOptions::default();
        let [a, b] = [&hand, &large].map(|mesh| {
            let surface = Surface::new(mesh, &RepairOptions::default()).unwrap();
            embed(&surface, &options, &()).unwrap().form(&surface).unwrap()
        });
        let (comparison, overlay) = overlay_forms([&a, &b], &MatchOptions::default()).unwrap();
        assert_eq!(comparison, compare_forms(&a, &b, &MatchOptions::default()).unwrap());
        for (mine, other) in [(0, 1), (1, 0)] {
            let (points, others) = (&overlay.points[mine], &overlay.points[other]);
            for (p, residual) in points.iter().zip(&overlay.residuals[mine]).step_by(97) {
                let nearest = others.iter().map(|q| (p - q).norm()).fold(f64::INFINITY, f64::min);
                assert!((nearest - residual).abs() < 1e-9, "{nearest} {residual}");
            }
        }
        let spread = |points: &[Point3<f64>]| points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let ratio = spread(&overlay.points[0]) / spread(&overlay.points[1]);
        assert!((0.8..1.3).contains(&ratio), "of one size: {ratio}");
    }

    #[test]
    fn residuals_are_largest_where_a_shape_was_changed() {
        let (whole, changed) = (four_arms([1.0, 1.7, 2.6, 3.5]), four_arms([1.0, 1.7, 2.6, 3.1]));
        let found = compared(&whole, &changed);
        let residuals = &found.overlay.residuals[0];
        let worst = (0..residuals.len()).max_by(|&i, &j| residuals[i].total_cmp(&residuals[j]));
        assert!(whole.positions[worst.unwrap()].z > 2.0, "the tip of the long arm");
    }
}
