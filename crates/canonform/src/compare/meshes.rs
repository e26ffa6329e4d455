//! Two meshes side by side, from their files or from memory.

use std::borrow::Borrow;

use descriptors::{CanonicalForm, PreparedShape, ShapeMetric, ShapePair};
use index::ContentHash;
use mesh::TriMesh;
use serde::Serialize;
use surface::VertexId;

use super::comparison::{Comparison, Overlay, Residual, Triangulation, compare_surfaces};
use super::evidence::{MatchEvidence, MeshGeometry};
use crate::error::Error;
use crate::form::{DescribeOptions, FormOptions, ShapeDescription, describe_within, embed};
use crate::input::Surface;
use crate::observer::Observer;

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
    usual: Option<PreparedShape>,
}

impl<S: Borrow<Surface>> ComparedMesh<S> {
    /// Embeds and describes a mesh. `surface` is the repaired one, `content` the hash of its file.
    ///
    /// # Errors
    /// [`Error::Descriptor`] unless the form has three dimensions; those of [`embed`].
    pub fn new(
        mesh: &TriMesh,
        content: Option<ContentHash>,
        surface: S,
        options: &FormOptions,
        observer: &dyn Observer,
    ) -> Result<Self, Error> {
        options.validate()?;
        let geometry = MeshGeometry::new(mesh, content);
        let (repaired, budget) = (surface.borrow(), observer.budget());
        let usual = FormOptions { repair: repaired.repair, ..FormOptions::default() };
        let usual = DescribeOptions { form: usual, ..DescribeOptions::default() };
        let refined = repaired.for_description_within(&budget)?;
        let embedded = embed(&refined, options, observer)?;
        let form = embedded.form(&refined)?.leading(repaired.mesh().vertex_areas())?;
        if embedded.options == usual.form {
            let shape = ShapeDescription::within(&refined, &embedded, &usual, &budget)?.prepare()?;
            return Ok(Self { surface, geometry, form, shape, usual: None });
        }
        let description = describe_within(repaired, &usual, &budget)?;
        let (fused, area) = (description.fused.clone(), Some(description.area));
        let shape = PreparedShape::new(fused, &form.reduced(usual.points), area)?;
        Ok(Self { geometry, form, shape, usual: Some(description.prepare()?), surface })
    }

    /// The repaired mesh.
    pub fn surface(&self) -> &Surface {
        self.surface.borrow()
    }
}

/// How two meshes resemble each other; `canonform compare --json` prints it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshComparison {
    /// What kind of match the meshes are.
    pub evidence: MatchEvidence,
    /// The comparison of their shapes.
    #[serde(flatten)]
    pub comparison: Comparison,
    /// Whether the meshes have the same triangles.
    pub triangulation: Triangulation,
    /// The two forms laid over each other.
    #[serde(skip)]
    pub overlay: Overlay,
    /// Distances from the vertices of the first mesh to the second, in brief.
    #[serde(skip)]
    pub residual: Residual,
    /// The input vertex of the first mesh with the largest distance.
    #[serde(skip)]
    pub max_vertex: VertexId,
}

/// Compares two meshes. The verdict does not depend on the options that their forms were made with.
///
/// ```
/// use canonform::descriptors::{ShapeMetric, VerdictKind};
/// use canonform::{ComparedMesh, FormOptions, Surface, compare_meshes, mesh::shapes};
///
/// let flat = shapes::grid(21, 17, 0.1);
/// let folded = shapes::fold(&flat, 0.8, 1.2);
/// let mut sides = Vec::new();
/// for mesh in [&flat, &folded] {
///     let surface = Surface::new(mesh, &Default::default())?;
///     sides.push(ComparedMesh::new(mesh, None, surface, &FormOptions::default(), &())?);
/// }
/// let found = compare_meshes(ShapeMetric::default(), [&sides[0], &sides[1]])?;
/// assert_eq!(found.comparison.verdict.kind, VerdictKind::SameShape);
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare_meshes<S: Borrow<Surface>>(
    metric: ShapeMetric,
    [a, b]: [&ComparedMesh<S>; 2],
) -> Result<MeshComparison, Error> {
    let pair = ShapePair::new(metric, [&a.shape, &b.shape]);
    // The verdict must not depend on the options.
    let distance = match (&a.usual, &b.usual) {
        (None, None) => pair.distance(),
        (usual_a, usual_b) => {
            let usual = [usual_a.as_ref().unwrap_or(&a.shape), usual_b.as_ref().unwrap_or(&b.shape)];
            ShapePair::new(metric, usual).distance()
        }
    };
    let found = compare_surfaces(&pair, distance, [(a.surface(), &a.form), (b.surface(), &b.form)])?;
    let verdict = found.comparison.verdict;
    let evidence = match (&a.geometry, &b.geometry) {
        (Some(a), Some(b)) => MatchEvidence::new([a, b], verdict),
        _ => MatchEvidence::of_shapes([None, None], verdict),
    };
    let [residual, _] = found.overlay.residual();
    Ok(MeshComparison {
        evidence,
        comparison: found.comparison,
        triangulation: found.triangulation,
        max_vertex: a.surface().input_vertex(residual.max_point.into()),
        overlay: found.overlay,
        residual,
    })
}
