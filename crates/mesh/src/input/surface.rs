//! A repaired mesh, ready for distances.

use std::time::Instant;

use ::surface::{IntrinsicMesh, Link, VertexId};
use base::{Exceeded, Observer};
use nalgebra::Point3;

use super::point::{InputPoint, PointError};
use crate::boundary::boundaries;
use crate::remap::{Remap, Remapped};
use crate::repair::FacePart;
use crate::{MeshError, RepairOptions, RepairReport, Repaired, Shortcut, TriMesh, collapse_edges, repair};

/// A repaired mesh, its intrinsic geometry, and the way back to the input.
#[derive(Debug, Clone)]
pub struct Surface {
    /// The input, and where its vertices went.
    pub input: InputMap,
    mesh: TriMesh,
    intrinsic: IntrinsicMesh,
    /// Parts of faces that were split at T-junctions; none on a prepared surface.
    pub(super) parts: Vec<FacePart>,
    /// Length of the longest boundary of the surface of which this one is the prepared copy.
    pub(super) open_boundary: Option<f64>,
    /// Shortcuts of the surface of which this one is the prepared copy. They are cut.
    shortcuts: Vec<Shortcut>,
}

/// The input of a surface, and where its vertices went, without the mesh.
#[derive(Debug, Clone)]
pub struct InputMap {
    /// How the mesh was repaired.
    pub repair: RepairOptions,
    /// What was repaired.
    pub report: RepairReport,
    /// The faces of the input, or those of the surface through its points if it has none, in the vertex numbers of the
    /// input.
    pub faces: Vec<[VertexId; 3]>,
    /// From the vertices of the input to those of the surface. [Prepared](Surface::for_description) surfaces have more.
    pub remap: Remap,
    /// Seconds to read the file; zero for a mesh in memory.
    pub load_seconds: f64,
    /// Seconds to repair the mesh and to build the connectivity.
    pub repair_seconds: f64,
}

impl InputMap {
    /// The vertex of the surface that an input vertex became.
    ///
    /// # Errors
    /// [`PointError::NoSuchPoint`] and [`PointError::Dropped`].
    pub fn repaired_vertex(&self, input: VertexId) -> Result<VertexId, PointError> {
        let point = InputPoint::Vertex(input);
        match self.remap.to_new(input) {
            Some(vertex) => Ok(vertex),
            None if input.index() < self.remap.n_old() => Err(PointError::Dropped { point }),
            None => Err(self.no_such(point)),
        }
    }

    /// The error that the input has no such point.
    pub(super) fn no_such(&self, point: InputPoint) -> PointError {
        PointError::NoSuchPoint { point, n_vertices: self.remap.n_old(), n_faces: self.faces.len() }
    }

    /// The faces of the input with new positions, given for the vertices of the surface. Vertices that the
    /// repair dropped have no position; they are left out, and so are their faces.
    pub fn with_positions(&self, position: impl Fn(VertexId) -> Point3<f64>) -> TriMesh {
        let mut kept = Vec::with_capacity(self.remap.n_old());
        let number: Vec<Option<VertexId>> = self
            .remap
            .all_to_new()
            .map(|vertex| {
                kept.push(position(vertex?));
                Some(VertexId::from(kept.len() - 1))
            })
            .collect();
        let renumbered = |face: &[VertexId; 3]| {
            let [a, b, c] = face.map(|v| number[v.index()]);
            Some([a?, b?, c?])
        };
        TriMesh { faces: self.faces.iter().filter_map(renumbered).collect(), positions: kept }
    }
}

impl Surface {
    /// Repairs a mesh in memory. Vertices keep their order; the report lists every change. A mesh without faces is a
    /// point cloud and gets [faces](crate::triangulate_points) first.
    ///
    /// ```
    /// use canonform_mesh::{Surface, shapes};
    ///
    /// let pieces = shapes::disjoint(&[shapes::icosphere(2), shapes::cube(0)]);
    /// let surface = Surface::new(&pieces, &Default::default(), &())?;
    /// assert_eq!(surface.mesh().n_vertices(), 162, "only the largest component is kept");
    /// assert!(surface.input.report.dropped_area_share > 0.0);
    /// # Ok::<(), canonform_mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError`], also for an exceeded budget.
    pub fn new(mesh: &TriMesh, options: &RepairOptions, observer: &dyn Observer) -> Result<Self, MeshError> {
        let start = Instant::now();
        let Repaired { mesh: repaired, intrinsic, remap, parts, report } = repair(mesh, options, observer)?;
        observer.budget().check()?;
        let faces = match mesh.faces.is_empty() {
            false => mesh.faces.clone(),
            true => repaired.faces.iter().map(|face| face.map(|v| remap.to_old(v))).collect(),
        };
        let repair_seconds = start.elapsed().as_secs_f64();
        let input = InputMap { repair: *options, report, faces, remap, load_seconds: 0.0, repair_seconds };
        let shortcuts = Vec::new();
        Ok(Self { input, mesh: repaired, intrinsic, parts, open_boundary: None, shortcuts })
    }

    /// The geometry, and everything that relates results to the input. The mesh with its coordinates is dropped.
    pub fn into_parts(self) -> (IntrinsicMesh, InputMap) {
        (self.intrinsic, self.input)
    }

    /// The same surface on a mesh that was made of its own, cut at `shortcuts`. Links move with their ends.
    pub(crate) fn with_mesh(&self, Remapped { mesh, remap }: Remapped, shortcuts: Vec<Shortcut>) -> Self {
        let moved = |link: &Link| {
            let [a, b] = link.ends.map(|v| remap.to_new(v));
            Some(Link { ends: [a?, b?], ..*link }).filter(|link| link.ends[0] != link.ends[1])
        };
        let links = self.intrinsic.links().iter().filter_map(moved).collect();
        Self {
            intrinsic: mesh.intrinsic().with_links(links),
            mesh,
            // Parts name vertices.
            parts: if remap.keeps_numbers() { self.parts.clone() } else { Vec::new() },
            open_boundary: Some(self.longest_boundary()),
            shortcuts,
            input: InputMap { remap: self.input.remap.then(&remap), ..self.input.clone() },
        }
    }

    /// The same surface with at most `n_vertices` vertices, by [edge collapses](crate::collapse_edges) of least quadric error,
    /// and where the vertices of this surface went. `None` if it has no more. Boundaries stay where
    /// they are, and the report on the repair is that of this surface.
    ///
    /// # Errors
    /// [`Exceeded`].
    pub fn simplified(
        &self,
        n_vertices: usize,
        observer: &dyn Observer,
    ) -> Result<Option<(Self, Remap)>, Exceeded> {
        if self.mesh.n_vertices() <= n_vertices {
            return Ok(None);
        }
        let found = collapse_edges(&self.mesh, n_vertices, &|error, _, _| error, &observer.budget())?;
        let remap = found.remap.clone();
        Ok(Some((self.with_mesh(found, self.shortcuts.clone()), remap)))
    }

    /// Length of the longest boundary of the repaired mesh, in mesh units.
    pub fn longest_boundary(&self) -> f64 {
        let lengths = || boundaries(self.intrinsic()).into_iter().map(|(_, length)| length);
        self.open_boundary.unwrap_or_else(|| lengths().fold(0.0, f64::max))
    }

    /// The vertices on boundaries, and the length of all, in mesh units.
    pub fn boundary_vertices(&self) -> (Vec<VertexId>, f64) {
        let (vertices, lengths): (Vec<_>, Vec<f64>) = boundaries(self.intrinsic()).into_iter().unzip();
        // The sum of nothing would be minus zero.
        (vertices.concat(), lengths.iter().fold(0.0, |sum, length| sum + length))
    }

    /// The shortcuts that were cut to [prepare](Self::for_description) the surface; none before.
    pub fn shortcuts(&self) -> &[Shortcut] {
        &self.shortcuts
    }

    /// Connectivity and edge lengths of the repaired mesh, including bridges.
    pub fn intrinsic(&self) -> &IntrinsicMesh {
        &self.intrinsic
    }

    /// The repaired mesh.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// Number of vertices of the input.
    pub fn n_input_vertices(&self) -> usize {
        self.input.remap.n_old()
    }

    /// The vertex of the repaired mesh that an input vertex became.
    ///
    /// # Errors
    /// [`PointError::NoSuchPoint`] and [`PointError::Dropped`].
    pub fn repaired_vertex(&self, input: VertexId) -> Result<VertexId, PointError> {
        self.input.repaired_vertex(input)
    }

    /// The first input vertex that was mapped to this vertex of the repaired mesh.
    pub fn input_vertex(&self, vertex: VertexId) -> VertexId {
        self.input.remap.to_old(vertex)
    }

    /// The input of this surface, to be shown: of a point cloud, the surface through its points, with a vertex for every
    /// point; any other mesh as it is.
    pub fn shown(&self, input: TriMesh) -> TriMesh {
        if !input.faces.is_empty() {
            return input;
        }
        let moved = |(p, vertex): (&Point3<f64>, Option<VertexId>)| {
            vertex.map_or(*p, |v| self.mesh.positions[v.index()])
        };
        let positions = input.positions.iter().zip(self.input.remap.all_to_new()).map(moved).collect();
        TriMesh { positions, faces: self.input.faces.clone() }
    }

    /// Puts values of the repaired vertices into the order of the input, with `missing` for dropped vertices.
    pub fn in_input_order<T: Copy>(&self, values: &[T], missing: T) -> Vec<T> {
        self.input.remap.all_to_new().map(|vertex| vertex.map_or(missing, |v| values[v.index()])).collect()
    }
}
