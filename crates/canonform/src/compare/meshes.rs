//! Two meshes side by side, from their files or from memory.

use std::borrow::Borrow;

use base::{ContentHash, Observer};
use descriptors::{CanonicalForm, PreparedShape, ShapePair};
use mesh::{Surface, TriMesh};
use relations::{MeshGeometry, Relation};
use rigid::Handedness;
use serde::Serialize;

use super::comparison::{Comparison, FaceAgreement, Overlay};
use crate::error::Error;
use crate::form::{DescribeOptions, FormOptions, MeasuredSurface};

/// A mesh, ready to be compared with others.
#[derive(Debug)]
pub struct ComparedMesh<S = Surface> {
    /// The repaired mesh.
    pub surface: S,
    /// The mesh in space, unless it has no area.
    pub geometry: Option<MeshGeometry>,
    /// The form of all vertices of the repaired mesh.
    pub form: CanonicalForm,
    /// The shape with this form.
    pub shape: PreparedShape,
    /// The shape made with the options that the metric is calibrated for, if those differ.
    reference: Option<PreparedShape>,
}

impl<S: Borrow<Surface>> ComparedMesh<S> {
    /// Embeds and describes a mesh. `surface` is the repaired one, `content` the hash of its file.
    ///
    /// # Errors
    /// [`Error::Descriptor`] unless the form has three dimensions; those of [`MeasuredSurface::new`].
    pub fn new(
        mesh: &TriMesh,
        content: Option<ContentHash>,
        surface: S,
        options: &FormOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        options.validate()?;
        let geometry = MeshGeometry::new(mesh, content);
        let repaired = surface.borrow();
        let reference = FormOptions { repair: repaired.input.repair, ..FormOptions::default() };
        let reference = DescribeOptions { form: reference, ..DescribeOptions::default() };
        let measured = MeasuredSurface::new(repaired, options, observer)?;
        let form = measured.form_of(repaired)?;
        if *measured.options() == reference.form {
            let shape = measured.prepare(&reference, observer)?;
            return Ok(Self { surface, geometry, form, shape, reference: None });
        }
        let described =
            MeasuredSurface::new(repaired, &reference.form, observer)?.prepare(&reference, observer)?;
        let shape = described.with_form(&form.reduced(reference.points))?;
        Ok(Self { geometry, form, shape, reference: Some(described), surface })
    }

    /// The repaired mesh.
    pub fn surface(&self) -> &Surface {
        self.surface.borrow()
    }

    /// The mesh as one of two that are compared.
    pub fn compared(&self) -> Compared<'_> {
        Compared {
            shape: &self.shape,
            reference: self.reference.as_ref().unwrap_or(&self.shape),
            form: &self.form,
            surface: Some(self.surface()),
            geometry: self.geometry.as_ref(),
            content: None,
        }
    }
}

/// One of two shapes that are compared, with what is known of its mesh.
#[derive(Debug, Clone, Copy)]
pub struct Compared<'a> {
    /// The shape whose form is compared.
    pub shape: &'a PreparedShape,
    /// The same shape, made with the options that the metric is calibrated for: shapes are related by it, whatever the options.
    pub reference: &'a PreparedShape,
    /// Its form: at all vertices of the surface if there is one.
    pub form: &'a CanonicalForm,
    /// Its repaired mesh.
    pub surface: Option<&'a Surface>,
    /// Its mesh in space.
    pub geometry: Option<&'a MeshGeometry>,
    /// The hash of its file, if the geometry does not have it.
    pub content: Option<ContentHash>,
}

/// How two meshes resemble each other; `canonform compare --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshComparison {
    /// How they are related.
    pub relation: Relation,
    /// The numbers of their shapes.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Whether the meshes have the same triangles; unknown without both surfaces.
    pub triangulation: Option<FaceAgreement>,
    /// The two forms laid over each other.
    #[serde(skip)]
    pub overlay: Overlay,
}

/// Compares two meshes: how they are related, how far apart their shapes are, and where they differ. The relation does not
/// depend on the options that their forms were made with. What is not known of a mesh is not compared.
///
/// ```
/// use canonform::Surface;
/// use canonform::compare::{ComparedMesh, compare_meshes};
/// use canonform::embed::FormOptions;
/// use canonform::mesh::shapes;
/// use canonform::relations::RelationKind;
///
/// let flat = shapes::grid(21, 17, 0.1);
/// let folded = shapes::fold(&flat, 0.8, 1.2);
/// let mut sides = Vec::new();
/// for mesh in [&flat, &folded] {
///     let surface = Surface::new(mesh, &Default::default(), &())?;
///     sides.push(ComparedMesh::new(mesh, None, surface, &FormOptions::default(), &())?);
/// }
/// let found = compare_meshes([sides[0].compared(), sides[1].compared()])?;
/// assert_eq!(found.relation.kind, RelationKind::OtherPose);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare_meshes([a, b]: [Compared<'_>; 2]) -> Result<MeshComparison, Error> {
    let pair = ShapePair::new([a.shape, b.shape]);
    let is_reference = std::ptr::eq(a.shape, a.reference) && std::ptr::eq(b.shape, b.reference);
    let distance =
        if is_reference { pair.distance() } else { ShapePair::new([a.reference, b.reference]).distance() };
    let (handedness, triangulation) = match (a.surface, b.surface) {
        (Some(of_a), Some(of_b)) => {
            let same =
                of_a.input.faces == of_b.input.faces && of_a.n_input_vertices() == of_b.n_input_vertices();
            let triangulation = if same { FaceAgreement::Same } else { FaceAgreement::Other };
            (pair.handedness([(a.form, of_a.mesh()), (b.form, of_b.mesh())])?, Some(triangulation))
        }
        _ => (Handedness::Unknown, None),
    };
    let relation = Relation::by_distance(distance, pair.scale(), handedness).by_files([a.content, b.content]);
    let relation = match (a.geometry, b.geometry) {
        (Some(a), Some(b)) => relation.by_meshes([a, b]),
        _ => relation,
    };
    Ok(MeshComparison {
        relation,
        comparison: Comparison::new(&pair, distance)?,
        triangulation,
        overlay: Overlay::new(&pair, [a.form, b.form])?,
    })
}

#[cfg(test)]
mod tests {
    use descriptors::Normalization;
    use mesh::shapes;
    use nalgebra::Point3;
    use relations::Change;

    use super::*;
    use crate::compare::compare;
    use crate::form::EmbedMethod;

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
        let surface = Surface::new(mesh, &options.form.repair, &()).unwrap();
        let measured = MeasuredSurface::new(&surface, &options.form, &()).unwrap();
        let form = measured.form_of(&surface).unwrap();
        let shape = measured.prepare(options, &()).unwrap();
        Described { surface, form, shape }
    }

    /// Two meshes by their shapes and surfaces alone.
    fn compared_by(options: &DescribeOptions, meshes: [&TriMesh; 2]) -> MeshComparison {
        let all = meshes.map(|mesh| described(mesh, options));
        let sides = all.each_ref().map(|Described { surface, form, shape }| Compared {
            shape,
            reference: shape,
            form,
            surface: Some(surface),
            geometry: None,
            content: None,
        });
        let found = compare_meshes(sides).unwrap();
        // The same numbers without the surfaces.
        let pair = ShapePair::new([&all[0].shape, &all[1].shape]);
        assert_eq!(compare(&pair).unwrap(), found.comparison);
        found
    }

    fn compared(a: &TriMesh, b: &TriMesh) -> MeshComparison {
        compared_by(&DescribeOptions::default(), [a, b])
    }

    fn scaled(mesh: &TriMesh, factor: f64) -> TriMesh {
        testkit::moved(mesh, |p| p * factor)
    }

    #[test]
    fn mirror_images_differ_from_resized_and_from_equal_shapes() {
        let hand = four_arms([1.0, 2.0, 3.4, 5.0]);
        // Reflected as by a mirror: positions, and faces so that normals still point outwards.
        let inside_out = testkit::moved(&hand, |p| Point3::new(-p.x, p.y, p.z));
        let mut other = inside_out.clone();
        other.faces.iter_mut().for_each(|face| face.swap(1, 2));
        let found = compared(&hand, &hand);
        assert_eq!((found.relation.changes.len(), found.triangulation), (0, Some(FaceAgreement::Same)));
        assert_eq!(found.relation.evidence.handedness, Handedness::Same);
        assert!(found.overlay.residuals.iter().flatten().all(|r| *r < 1e-4));
        for mirrored in [&other, &inside_out] {
            let found = compared(&hand, mirrored);
            assert_eq!(found.relation.changes, [Change::Mirrored], "{:?}", found.relation);
        }
        let found = compared(&hand, &scaled(&other, 3.0));
        assert_eq!(found.relation.changes, [Change::Scaled, Change::Mirrored]);
        assert_eq!(found.triangulation, Some(FaceAgreement::Other), "the faces are reversed");
        let ball = shapes::icosphere(3);
        assert_eq!(compared(&ball, &ball).relation.evidence.handedness, Handedness::Either);
        let sheet = shapes::grid(12, 9, 0.1);
        assert_eq!(compared(&sheet, &sheet).relation.evidence.handedness, Handedness::Unknown);
    }

    #[test]
    fn size_does_not_count_whatever_vectors_and_forms_contain_of_it() {
        let small = shapes::torus(24, 12, 2.0, 0.7);
        // A power of two, since other factors may change which of many equal first samples is chosen.
        let large = scaled(&small, 4.0);
        let method = EmbedMethod::KernelPca { rank: None, bandwidth: Default::default() };
        let without_unit = FormOptions { method, ..FormOptions::default() };
        for (form, size) in [
            (FormOptions::default(), Normalization::UnitArea),
            (FormOptions::default(), Normalization::Raw),
            (without_unit, Normalization::UnitArea),
        ] {
            let options = DescribeOptions { form, size, ..DescribeOptions::default() };
            let MeshComparison { comparison, relation, .. } = compared_by(&options, [&small, &large]);
            assert!(comparison.shape_distance.combined < 0.01 && relation.has(Change::Scaled));
            assert!((comparison.scale - 4.0).abs() < 1e-9);
            let has_unit = options.form.method.has_unit();
            assert_eq!(comparison.distance == comparison.normalized_distance, !has_unit);
        }
    }

    #[test]
    fn residuals_are_distances_to_the_other_aligned_form() {
        let (hand, changed) = (four_arms([1.0, 1.7, 2.6, 3.5]), four_arms([1.0, 1.4, 2.6, 3.1]));
        let overlay = compared(&hand, &scaled(&changed, 5.0)).overlay;
        for [mine, other] in [[0, 1], [1, 0]] {
            for (p, residual) in overlay.points[mine].iter().zip(&overlay.residuals[mine]).step_by(97) {
                let gaps = overlay.points[other].iter().map(|q| (p - q).norm());
                assert!((gaps.fold(f64::INFINITY, f64::min) - residual).abs() < 1e-9);
            }
        }
        let spread = |points: &[Point3<f64>]| points.iter().map(|p| p.coords.norm()).fold(0.0, f64::max);
        let ratio = spread(&overlay.points[0]) / spread(&overlay.points[1]);
        assert!((0.8..1.3).contains(&ratio), "of one size: {ratio}");
    }
}
