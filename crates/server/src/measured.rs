//! A mesh with its form, as geometry for the browser.

use std::sync::Arc;

use canonform::compare::Overlay;
use canonform::descriptors::CanonicalForm;
use canonform::embed::{FormOptions, MeasuredSurface};
use canonform::maps::SurfaceMap;
use canonform::mesh::TriMesh;
use canonform::relations::{MeshGeometry, MeshOverlay};
use canonform::surface::VertexId;
use canonform::{Budget, ContentHash, Error, Surface};
use report::viewer::Geometry;

/// Bytes of a vertex and of a face in memory, with the connectivity, all arrays together.
const VERTEX_BYTES: usize = 250;
const FACE_BYTES: usize = 150;

/// Names of the values on meshes and forms.
const DISTANCE: &str = "distance along the surface";
const RESIDUAL: &str = "distance to the other form";
const GAP: &str = "distance to the other mesh";

/// Size of the dots drawn at points, as a fraction of the spread of the form.
const DOT: f64 = 0.025;

/// A repaired surface and the form of all its vertices.
pub(crate) struct Measured {
    pub(crate) surface: Surface,
    /// The mesh in space, with all its components; none for one without area.
    pub(crate) geometry: Option<Arc<MeshGeometry>>,
    pub(crate) form: CanonicalForm,
    /// Surface distance of every vertex from the first sample, in mesh units.
    distances: Vec<f64>,
}

impl Measured {
    /// Measures a mesh. The embedding can describe it.
    pub(crate) fn new(
        mesh: &TriMesh,
        content: ContentHash,
        options: &FormOptions,
        budget: &Budget,
    ) -> Result<(Self, MeasuredSurface), Error> {
        budget.check()?;
        let surface = Surface::new(mesh, &options.repair, budget)?;
        let embedded = MeasuredSurface::new(&surface, options, budget)?;
        let geometry = MeshGeometry::new(mesh, Some(content)).map(Arc::new);
        let (form, distances) = (embedded.form_of(&surface)?, embedded.distances_from_first()?);
        Ok((Self { surface, geometry, form, distances }, embedded))
    }

    /// Approximate size in memory.
    pub(crate) fn bytes(&self) -> usize {
        let mesh = self.surface.mesh();
        let geometry = self.geometry.as_ref().map_or(0, |geometry| geometry.n_bytes());
        VERTEX_BYTES * mesh.n_vertices() + FACE_BYTES * mesh.n_faces() + geometry
    }

    /// The repaired mesh, colored by distance from the first sample.
    pub(crate) fn mesh(&self) -> Geometry {
        Geometry::new(self.surface.mesh()).with_values(DISTANCE, &self.distances)
    }

    /// The repaired mesh in the colors of another, carried to it by a map to that one.
    pub(crate) fn carried(&self, from: &Self, map: &SurfaceMap) -> Geometry {
        let value = |v: usize| {
            let input = self.surface.input_vertex(VertexId::from(v));
            let partner = map.vertices.get(input.index()).copied().flatten()?;
            from.distances.get(from.surface.repaired_vertex(partner).ok()?.index()).copied()
        };
        let values: Vec<f64> =
            (0..self.surface.mesh().n_vertices()).map(|v| value(v).unwrap_or(f64::NAN)).collect();
        Geometry::new(self.surface.mesh()).with_values(DISTANCE, &values)
    }

    /// The form with the faces and colors of the mesh.
    pub(crate) fn form(&self) -> Geometry {
        let form = self.form.to_mesh(self.surface.mesh());
        Geometry::new(&form).with_values(DISTANCE, &self.distances)
    }
}

/// A form without a mesh: its points as dots.
pub(crate) fn dots(form: &CanonicalForm) -> TriMesh {
    report::render::dots(form.points(), DOT * form.spread())
}

/// Both meshes of an overlay in space.
pub(crate) fn in_space(overlay: &MeshOverlay) -> [Geometry; 2] {
    [0, 1].map(|i| Geometry::in_place(&overlay.meshes[i]).with_values(GAP, &overlay.gaps[i]))
}

/// One form of an overlay: with the faces of its mesh, or as dots if the mesh is missing.
pub(crate) fn overlaid(overlay: &Overlay, place: usize, measured: Option<&Measured>, dot: f64) -> Geometry {
    let (points, residuals) = (&overlay.points[place], &overlay.residuals[place]);
    let mesh = match measured.map(|measured| measured.surface.mesh().faces.clone()) {
        Some(faces) => TriMesh { positions: points.clone(), faces },
        None => report::render::dots(points, DOT * dot),
    };
    let each = mesh.n_vertices() / points.len().max(1);
    let values: Vec<f64> = residuals.iter().flat_map(|r| std::iter::repeat_n(*r, each)).collect();
    Geometry::in_place(&mesh).with_values(RESIDUAL, &values)
}
