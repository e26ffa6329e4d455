//! Two shapes side by side.

use descriptors::{
    Alignment, CanonicalForm, FormMatch, Handedness, MatchKind, NearestPoints, Reflections, ShapeDistance,
    ShapeMetric, ShapePair, Verdict, handedness,
};
use nalgebra::Point3;
use serde::Serialize;

use crate::error::Error;
use crate::input::Surface;

/// How two shapes resemble each other, and how far apart they are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// How alike the shapes are, and why.
    pub verdict: Verdict,
    /// By which change of size and handedness the second matches the first; `different` if they are of different
    /// classes rather than of one. It does not tell one shape from one class: the verdict does.
    pub kind: MatchKind,
    /// Distance between the aligned forms, in mesh units.
    pub distance: f64,
    /// Distance between the aligned forms once both have unit area: 0 for the same shape at any size.
    pub normalized_distance: f64,
    /// Value of `normalized_distance` from which on `kind` is `different` for shapes with these signatures; 0 if the
    /// signatures alone are too far apart.
    pub same_below: f64,
    /// The distances that decide on the verdict and on `kind`.
    #[serde(flatten)]
    pub shape_distance: ShapeDistance,
    /// Size of the second surface over that of the first, by the square roots of their areas.
    pub scale: f64,
    /// Whether the best motion includes a reflection.
    pub reflected: bool,
    /// `normalized_distance` if only motions without reflection are allowed.
    pub unreflected_distance: f64,
    /// Whether one surface is the mirror image of the other. Unknown unless the surfaces were compared, see
    /// [`compare_surfaces`]: forms do not tell.
    pub handedness: Handedness,
    /// Rows of the matrix that turns the first form onto the second.
    pub rotation: [[f64; 3]; 3],
    /// The translation after the rotation, in mesh units.
    pub translation: [f64; 3],
}

impl Comparison {
    /// Compares the forms of a pair; `distance` and `handedness` decide on the verdict.
    pub(crate) fn new(
        pair: &ShapePair<'_>,
        distance: ShapeDistance,
        handedness: Handedness,
    ) -> Result<Self, Error> {
        let (best, proper, raw) = (pair.best(), pair.best_with(Reflections::Forbid), pair.align_raw()?);
        let shown = |found: FormMatch| found.distance(pair.metric.distance);
        let Alignment { rotation, translation, reflected } = raw.alignment;
        let scale = pair.scale();
        let verdict = ShapeMetric::verdict(distance, handedness, scale);
        Ok(Self {
            verdict,
            kind: verdict.match_kind(),
            distance: shown(raw),
            normalized_distance: shown(best),
            same_below: pair.metric.same_below(ShapeMetric::robust_part(distance.combined, best.rms)),
            shape_distance: distance,
            scale,
            reflected,
            unreflected_distance: shown(proper).max(shown(best)),
            handedness,
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
            translation: translation.into(),
        })
    }
}

/// Compares the shapes of a pair, without their surfaces.
///
/// ```
/// use canonform::descriptors::{ShapeMetric, ShapePair, VerdictKind};
/// use canonform::{DescribeOptions, Surface, compare, describe, mesh::shapes};
///
/// let sheet = shapes::grid(21, 17, 0.1);
/// let [flat, folded, ball] = [&sheet, &shapes::fold(&sheet, 0.8, 1.2), &shapes::icosphere(3)].map(|mesh| {
///     let surface = Surface::new(mesh, &Default::default())?;
///     describe(&surface, &DescribeOptions::default())?.prepare()
/// });
/// let (metric, flat) = (ShapeMetric::default(), flat?);
/// assert_eq!(compare(&ShapePair::new(metric, [&flat, &folded?]))?.verdict.kind, VerdictKind::SameShape);
/// assert_eq!(compare(&ShapePair::new(metric, [&flat, &ball?]))?.verdict.kind, VerdictKind::Different);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare(pair: &ShapePair<'_>) -> Result<Comparison, Error> {
    Comparison::new(pair, pair.distance(), Handedness::Unknown)
}

/// Whether two meshes have the same triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Triangulation {
    /// The same faces over the same vertex numbers: one mesh in two poses.
    Same,
    /// Different faces or vertex numbers.
    Other,
}

/// The comparison of two surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceComparison {
    /// The comparison, with the handedness.
    pub comparison: Comparison,
    /// Whether the meshes have the same triangles.
    pub triangulation: Triangulation,
    /// The two forms laid over each other.
    pub overlay: Overlay,
}

/// Two aligned forms at the size of the first, in units of its mesh, at the position of the second.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// The points of either form.
    pub points: [Vec<Point3<f64>>; 2],
    /// For every point of either form, the distance to the nearest point of the other.
    pub residuals: [Vec<f64>; 2],
}

/// The distances of the points of one form from the other, in brief.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Residual {
    /// The median; of two in the middle, the upper one.
    pub median: f64,
    /// The largest distance.
    pub max: f64,
    /// The point with the largest distance; the last of equals.
    #[serde(skip)]
    pub max_point: usize,
}

impl Overlay {
    /// Aligns two forms by the best alignment of a pair. The forms may have more points than those that
    /// were aligned.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn new(pair: &ShapePair<'_>, forms: [&CanonicalForm; 2]) -> Result<Self, Error> {
        let (motion, [a, b]) = (pair.best().alignment, pair.shapes);
        let size = a.size();
        let moved = a.at_unit_area(forms[0]).iter().map(|p| motion.apply(p)).collect();
        let (a, b) = (NearestPoints::new(moved)?, NearestPoints::new(b.at_unit_area(forms[1]))?);
        let residuals = |from: &NearestPoints, to: &NearestPoints| {
            from.points().iter().map(|p| to.nearest(p).1.sqrt() * size).collect()
        };
        let points = |form: &NearestPoints| form.points().iter().map(|p| p * size).collect();
        Ok(Self { points: [points(&a), points(&b)], residuals: [residuals(&a, &b), residuals(&b, &a)] })
    }

    /// The residuals of both forms, in brief; zero for a form without points.
    pub fn residual(&self) -> [Residual; 2] {
        self.residuals.each_ref().map(|residuals| {
            let mut order: Vec<usize> = (0..residuals.len()).collect();
            order.sort_by(|&i, &j| residuals[i].total_cmp(&residuals[j]));
            let Some(&max_point) = order.last() else { return Residual::default() };
            Residual { median: residuals[order[order.len() / 2]], max: residuals[max_point], max_point }
        })
    }
}

/// Compares two surfaces: their shapes, whether one is the mirror image of the other, and where they differ. `surfaces`
/// come with the forms of all their vertices; `distance` decides on the verdict and is that of the pair, unless
/// the forms of the pair were made in another way than the metric is calibrated for.
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare_surfaces(
    pair: &ShapePair<'_>,
    distance: ShapeDistance,
    [(a, form_a), (b, form_b)]: [(&Surface, &CanonicalForm); 2],
) -> Result<SurfaceComparison, Error> {
    let handedness = handedness(pair, [(form_a, a.mesh()), (form_b, b.mesh())])?;
    let same = a.input_faces == b.input_faces && a.n_input_vertices() == b.n_input_vertices();
    Ok(SurfaceComparison {
        comparison: Comparison::new(pair, distance, handedness)?,
        triangulation: if same { Triangulation::Same } else { Triangulation::Other },
        overlay: Overlay::new(pair, [form_a, form_b])?,
    })
}

#[cfg(test)]
mod tests {
    use descriptors::{FormDistance, Normalization, PreparedShape};
    use mesh::{TriMesh, shapes};

    use super::*;
    use crate::form::{DescribeOptions, EmbedMethod, FormOptions, ShapeDescription, embed};

    /// A ball with arms of these lengths towards the corners of a tetrahedron: its mirror image is another shape.
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

    struct Described {
        surface: Surface,
        form: CanonicalForm,
        shape: PreparedShape,
    }

    fn described(mesh: &TriMesh, options: &DescribeOptions) -> Described {
        let surface = Surface::new(mesh, &options.form.repair).unwrap();
        let embedded = embed(&surface, &options.form, &()).unwrap();
        let form = embedded.form(&surface).unwrap();
        let shape = ShapeDescription::new(&surface, &embedded, options).unwrap().prepare().unwrap();
        Described { surface, form, shape }
    }

    fn compared_by(
        metric: ShapeMetric,
        options: &DescribeOptions,
        meshes: [&TriMesh; 2],
    ) -> SurfaceComparison {
        let [a, b] = meshes.map(|mesh| described(mesh, options));
        let pair = ShapePair::new(metric, [&a.shape, &b.shape]);
        let surfaces = [(&a.surface, &a.form), (&b.surface, &b.form)];
        let found = compare_surfaces(&pair, pair.distance(), surfaces).unwrap();
        // The same numbers without the surfaces.
        let shapes = compare(&ShapePair::new(metric, [&a.shape, &b.shape])).unwrap();
        let Comparison { verdict, kind, handedness, .. } = found.comparison;
        let unhanded = Verdict { handedness: Handedness::Unknown, ..verdict };
        assert_eq!(shapes.verdict, unhanded, "only the handedness needs surfaces");
        assert_eq!(Comparison { verdict, kind, handedness, ..shapes }, found.comparison);
        found
    }

    fn compared(a: &TriMesh, b: &TriMesh) -> SurfaceComparison {
        compared_by(ShapeMetric::default(), &DescribeOptions::default(), [a, b])
    }

    fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
        let mut scaled = mesh.clone();
        scaled.positions.iter_mut().for_each(|p| p.coords *= factor);
        scaled
    }

    #[test]
    fn mirror_images_differ_from_resized_and_from_equal_shapes() {
        let hand = four_arms([1.0, 1.7, 2.6, 3.5]);
        // Reflected as by a mirror: positions, and faces so that normals still point outwards.
        let mut other = hand.clone();
        other.positions.iter_mut().for_each(|p| p.x = -p.x);
        let inside_out = other.clone();
        other.faces.iter_mut().for_each(|face| face.swap(1, 2));
        let found = compared(&hand, &hand);
        assert_eq!((found.comparison.kind, found.triangulation), (MatchKind::Same, Triangulation::Same));
        assert_eq!(found.comparison.handedness, Handedness::Same);
        assert!(found.overlay.residuals.iter().flatten().all(|r| *r < 1e-4));
        for mirrored in [&other, &inside_out] {
            let found = compared(&hand, mirrored);
            assert_eq!(found.comparison.kind, MatchKind::Mirrored, "{:?}", found.comparison);
        }
        let found = compared(&hand, &scaled(&other, 3.0));
        assert_eq!(found.comparison.kind, MatchKind::MirroredAndScaled);
        assert_eq!(found.triangulation, Triangulation::Other, "the faces are reversed");
        let ball = shapes::icosphere(3);
        assert_eq!(compared(&ball, &ball).comparison.handedness, Handedness::Either);
        let sheet = shapes::grid(12, 9, 0.1);
        assert_eq!(compared(&sheet, &sheet).comparison.handedness, Handedness::Unknown);
    }

    #[test]
    fn signatures_and_forms_together_decide_on_the_kind() {
        let (hand, ball) = (four_arms([1.0, 1.7, 2.6, 3.5]), shapes::icosphere(3));
        for (other, kind) in [(&scaled(&hand, 2.0), MatchKind::Scaled), (&ball, MatchKind::Different)] {
            let found = compared(&hand, other).comparison;
            assert_eq!(found.kind, kind);
            assert_eq!(found.normalized_distance < found.same_below, kind != MatchKind::Different);
            // Forms that fit do not make one shape if signatures are far apart.
            let [a, b] = [&hand, other].map(|mesh| described(mesh, &DescribeOptions::default()));
            let pair = ShapePair::new(ShapeMetric::default(), [&a.shape, &b.shape]);
            let apart = ShapeDistance { fused: 9.0, combined: 9.0 };
            let judged = Comparison::new(&pair, apart, Handedness::Unknown).unwrap();
            assert_eq!((judged.kind, judged.same_below), (MatchKind::Different, 0.0));
        }
    }

    #[test]
    fn the_distance_shown_does_not_change_the_verdict_and_has_its_own_threshold() {
        let (a, b) = (four_arms([1.0, 1.7, 2.6, 3.5]), four_arms([1.0, 1.6, 2.6, 3.4]));
        let [rms, hausdorff] =
            [FormDistance::NearestNeighborRms, FormDistance::Hausdorff95].map(|distance| {
                compared_by(ShapeMetric { distance }, &DescribeOptions::default(), [&a, &b]).comparison
            });
        assert_eq!((rms.kind, rms.shape_distance), (hausdorff.kind, hausdorff.shape_distance));
        assert_eq!(rms.rotation, hausdorff.rotation);
        assert!(hausdorff.normalized_distance > rms.normalized_distance);
        assert!(hausdorff.same_below > rms.same_below);
    }

    #[test]
    fn size_does_not_count_whether_or_not_vectors_contain_it() {
        let small = shapes::torus(24, 12, 2.0, 0.7);
        // A power of two, since other factors may change which of many equal first samples is chosen.
        let large = scaled(&small, 4.0);
        for size in [Normalization::UnitArea, Normalization::Raw] {
            let options = DescribeOptions { size, ..DescribeOptions::default() };
            let found = compared_by(ShapeMetric::default(), &options, [&small, &large]).comparison;
            assert!(found.shape_distance.combined < 0.01 && found.kind == MatchKind::Scaled, "{found:?}");
        }
    }

    #[test]
    fn forms_without_a_unit_are_compared_and_sizes_still_are() {
        let method = EmbedMethod::KernelPca { rank: None, bandwidth: Default::default() };
        let form = FormOptions { method, ..FormOptions::default() };
        let options = DescribeOptions { form, ..DescribeOptions::default() };
        let hand = four_arms([1.0, 1.7, 2.6, 3.5]);
        let found = compared_by(ShapeMetric::default(), &options, [&hand, &scaled(&hand, 2.0)]).comparison;
        assert_eq!(found.kind, MatchKind::Scaled);
        assert_eq!(found.distance, found.normalized_distance);
        assert!((found.scale - 2.0).abs() < 1e-9);
    }

    #[test]
    fn residuals_are_distances_to_the_other_aligned_form() {
        let (hand, changed) = (four_arms([1.0, 1.7, 2.6, 3.5]), four_arms([1.0, 1.4, 2.6, 3.1]));
        let overlay = compared(&hand, &scaled(&changed, 5.0)).overlay;
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
