//! A repaired mesh, ready for distances.

use std::time::Instant;

use ::surface::{IntrinsicMesh, Link, VertexId};
use base::{Exceeded, Observer};
use nalgebra::Point3;

use super::boundary::{boundaries, longest_boundary};
use super::point::{InputPoint, PointError};
use crate::{MeshError, RepairOptions, RepairReport, Repaired, Shortcut, TriMesh, collapse_edges, repair};

/// A repaired mesh, its intrinsic geometry, and the map back to the vertices of the input.
#[derive(Debug, Clone)]
pub struct Surface {
    /// How the mesh was repaired.
    pub repair: RepairOptions,
    /// The repaired mesh, its connectivity and edge lengths, the report on the repair, and the repaired vertex of each
    /// input vertex.
    pub repaired: Repaired,
    /// The faces of the input, or those of the surface through its points if it has none, in the vertex numbers of the
    /// input.
    pub input_faces: Vec<[VertexId; 3]>,
    /// Length of the longest boundary of the surface of which this one is the prepared copy.
    pub(super) open_boundary: Option<f64>,
    /// Shortcuts of the surface of which this one is the prepared copy. They are cut.
    shortcuts: Vec<Shortcut>,
    /// For every vertex of the repaired mesh, the first input vertex that was mapped to it.
    input_vertex: Vec<VertexId>,
    /// Seconds to read the file; zero for a mesh in memory.
    pub load_seconds: f64,
    /// Seconds to repair the mesh and to build the connectivity.
    pub repair_seconds: f64,
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
    /// assert!(surface.repaired.report.dropped_area_share > 0.0);
    /// # Ok::<(), canonform_mesh::MeshError>(())
    /// ```
    ///
    /// # Errors
    /// [`MeshError`], also for an exceeded budget.
    pub fn new(mesh: &TriMesh, options: &RepairOptions, observer: &dyn Observer) -> Result<Self, MeshError> {
        let start = Instant::now();
        let repaired = repair(mesh, options, observer)?;
        observer.budget().check()?;
        let mut input_vertex = vec![VertexId(u32::MAX); repaired.mesh.n_vertices()];
        for (input, vertex) in repaired.input_to_repaired.iter().enumerate().rev() {
            if let Some(vertex) = vertex {
                input_vertex[vertex.index()] = VertexId::from(input);
            }
        }
        let input_faces = match mesh.faces.is_empty() {
            false => mesh.faces.clone(),
            true => repaired.mesh.faces.iter().map(|face| face.map(|v| input_vertex[v.index()])).collect(),
        };
        Ok(Self {
            repair: *options,
            repaired,
            open_boundary: None,
            shortcuts: Vec::new(),
            input_faces,
            input_vertex,
            load_seconds: 0.0,
            repair_seconds: start.elapsed().as_secs_f64(),
        })
    }

    /// The geometry, and everything that relates results to the input. The mesh with its coordinates is dropped.
    #[must_use]
    pub fn into_parts(self) -> (IntrinsicMesh, InputMap) {
        let to_repaired = self.repaired.input_to_repaired;
        let stays = |(input, vertex): (usize, &Option<VertexId>)| *vertex == Some(VertexId::from(input));
        let changes =
            match to_repaired.len() == self.input_vertex.len() && to_repaired.iter().enumerate().all(stays) {
                true => None,
                false => Some(Changes { to_repaired, to_input: self.input_vertex }),
            };
        let map = InputMap {
            repair: self.repair,
            report: self.repaired.report,
            input_faces: self.input_faces,
            changes,
            load_seconds: self.load_seconds,
            repair_seconds: self.repair_seconds,
        };
        (self.repaired.intrinsic, map)
    }

    /// The same surface on another mesh, whose first vertices are those of the repaired mesh and which is cut at
    /// `shortcuts`. `origins` are vertices of the repaired mesh near the others.
    #[must_use]
    pub(crate) fn with_mesh(&self, mesh: TriMesh, origins: &[VertexId], shortcuts: Vec<Shortcut>) -> Self {
        let intrinsic = mesh.intrinsic().with_links(self.intrinsic().links().to_vec());
        let repaired = Repaired { mesh, intrinsic, ..self.repaired.clone() };
        let near = origins.iter().map(|&v| self.input_vertex(v));
        let input_vertex = self.input_vertex.iter().copied().chain(near).collect();
        let open_boundary = Some(self.longest_boundary());
        Self { repaired, input_vertex, open_boundary, shortcuts, ..self.clone() }
    }

    /// The same surface with at most `n_vertices` vertices, by [edge collapses](crate::collapse_edges) of least quadric error,
    /// and for every vertex of this surface the one that it was merged into. `None` if it has no more. Boundaries stay where
    /// they are, and the report on the repair is that of this surface.
    ///
    /// # Errors
    /// [`Exceeded`].
    pub fn simplified(
        &self,
        n_vertices: usize,
        observer: &dyn Observer,
    ) -> Result<Option<(Self, Vec<VertexId>)>, Exceeded> {
        if self.mesh().n_vertices() <= n_vertices {
            return Ok(None);
        }
        let found = collapse_edges(self.mesh(), n_vertices, &|error, _, _| error, &observer.budget())?;
        // Repaired meshes have no vertices without faces.
        let Some(vertex_of) = found.vertex_of.into_iter().collect::<Option<Vec<VertexId>>>() else {
            return Ok(None);
        };
        let moved = |link: &Link| Link { ends: link.ends.map(|v| vertex_of[v.index()]), ..*link };
        let links = self.intrinsic().links().iter().map(moved).filter(|link| link.ends[0] != link.ends[1]);
        let intrinsic = found.mesh.intrinsic().with_links(links.collect());
        let mut input_vertex = vec![VertexId(u32::MAX); found.mesh.n_vertices()];
        for (v, kept) in vertex_of.iter().enumerate().rev() {
            input_vertex[kept.index()] = self.input_vertex[v];
        }
        let to_input = |vertex: &Option<VertexId>| vertex.map(|v| vertex_of[v.index()]);
        let input_to_repaired = self.repaired.input_to_repaired.iter().map(to_input).collect();
        let report = self.repaired.report.clone();
        let parts = Vec::new();
        let repaired = Repaired { mesh: found.mesh, intrinsic, input_to_repaired, parts, report };
        let open_boundary = Some(self.longest_boundary());
        Ok(Some((Self { repaired, input_vertex, open_boundary, ..self.clone() }, vertex_of)))
    }

    /// Length of the longest boundary of the repaired mesh, in mesh units.
    pub fn longest_boundary(&self) -> f64 {
        self.open_boundary.unwrap_or_else(|| longest_boundary(self.intrinsic()))
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
        &self.repaired.intrinsic
    }

    /// The repaired mesh.
    pub fn mesh(&self) -> &TriMesh {
        &self.repaired.mesh
    }

    /// Number of vertices of the input.
    pub fn n_input_vertices(&self) -> usize {
        self.repaired.input_to_repaired.len()
    }

    /// The vertex of the repaired mesh that an input vertex became.
    ///
    /// # Errors
    /// [`PointError::NoSuchPoint`] and [`PointError::Dropped`].
    pub fn repaired_vertex(&self, input: VertexId) -> Result<VertexId, PointError> {
        let point = InputPoint::Vertex(input);
        let found = self.repaired.input_to_repaired.get(input.index());
        found.ok_or_else(|| self.no_such(point))?.ok_or(PointError::Dropped { point })
    }

    /// The error that the input has no such point.
    pub(super) fn no_such(&self, point: InputPoint) -> PointError {
        PointError::NoSuchPoint {
            point,
            n_vertices: self.n_input_vertices(),
            n_faces: self.input_faces.len(),
        }
    }

    /// The first input vertex that was mapped to this vertex of the repaired mesh.
    pub fn input_vertex(&self, vertex: VertexId) -> VertexId {
        self.input_vertex[vertex.index()]
    }

    /// The faces of the input with new positions, given for the vertices of the repaired mesh. Vertices that the
    /// repair dropped have no position; they are left out, and so are their faces.
    pub fn with_positions(&self, positions: &[Point3<f64>]) -> TriMesh {
        let to_repaired = &self.repaired.input_to_repaired;
        let position = |v: VertexId| positions[v.index()];
        with_positions(to_repaired.len(), &|input| to_repaired[input.index()], &self.input_faces, position)
    }

    /// The input of this surface, to be shown: of a point cloud, the surface through its points, with a vertex for every
    /// point; any other mesh as it is.
    #[must_use]
    pub fn shown(&self, input: TriMesh) -> TriMesh {
        if !input.faces.is_empty() {
            return input;
        }
        let moved = |(p, vertex): (&Point3<f64>, &Option<VertexId>)| {
            vertex.map_or(*p, |v| self.mesh().positions[v.index()])
        };
        let positions = input.positions.iter().zip(&self.repaired.input_to_repaired).map(moved).collect();
        TriMesh { positions, faces: self.input_faces.clone() }
    }

    /// Puts values of the repaired vertices into the order of the input, with `missing` for dropped vertices.
    pub fn in_input_order<T: Copy>(&self, values: &[T], missing: T) -> Vec<T> {
        let value = |vertex: &Option<VertexId>| vertex.map_or(missing, |v| values[v.index()]);
        self.repaired.input_to_repaired.iter().map(value).collect()
    }
}

/// The relation of the vertices of a repaired mesh to those of the input, without the mesh.
#[derive(Debug, Clone)]
pub struct InputMap {
    /// How the mesh was repaired.
    pub repair: RepairOptions,
    /// What was repaired.
    pub report: RepairReport,
    input_faces: Vec<[VertexId; 3]>,
    /// The vertices that the repair changed; `None` if it kept them all.
    changes: Option<Changes>,
    /// Seconds to read the file; zero for a mesh in memory.
    pub load_seconds: f64,
    /// Seconds to repair the mesh and to build the connectivity.
    pub repair_seconds: f64,
}

/// The vertices of the input and of the repaired mesh.
#[derive(Debug, Clone)]
struct Changes {
    /// For each input vertex, its vertex in the repaired mesh; `None` if it was dropped.
    to_repaired: Vec<Option<VertexId>>,
    /// For every vertex of the repaired mesh, the first input vertex that was mapped to it.
    to_input: Vec<VertexId>,
}

impl InputMap {
    /// Number of vertices of the input.
    pub fn n_input_vertices(&self) -> usize {
        self.report.input_vertices
    }

    /// The vertex of the repaired mesh that an input vertex became; see [`Surface::repaired_vertex`].
    ///
    /// # Errors
    /// [`PointError::NoSuchPoint`] and [`PointError::Dropped`].
    pub fn repaired_vertex(&self, input: VertexId) -> Result<VertexId, PointError> {
        let (point, n_vertices) = (InputPoint::Vertex(input), self.n_input_vertices());
        if input.index() >= n_vertices {
            return Err(PointError::NoSuchPoint { point, n_vertices, n_faces: self.input_faces.len() });
        }
        let found = self.changes.as_ref().map_or(Some(input), |changes| changes.to_repaired[input.index()]);
        found.ok_or(PointError::Dropped { point })
    }

    /// The first input vertex that was mapped to this vertex of the repaired mesh.
    pub fn input_vertex(&self, vertex: VertexId) -> VertexId {
        self.changes.as_ref().map_or(vertex, |changes| changes.to_input[vertex.index()])
    }

    /// The faces of the input with a new position for every vertex of the repaired mesh; see
    /// [`Surface::with_positions`].
    pub fn with_positions(&self, position: impl Fn(VertexId) -> Point3<f64>) -> TriMesh {
        with_positions(
            self.n_input_vertices(),
            &|v| self.repaired_vertex(v).ok(),
            &self.input_faces,
            position,
        )
    }
}

fn with_positions(
    n_input: usize,
    to_repaired: &dyn Fn(VertexId) -> Option<VertexId>,
    input_faces: &[[VertexId; 3]],
    position: impl Fn(VertexId) -> Point3<f64>,
) -> TriMesh {
    let mut number = vec![None; n_input];
    let mut kept = Vec::with_capacity(n_input);
    for (input, number) in number.iter_mut().enumerate() {
        if let Some(vertex) = to_repaired(VertexId::from(input)) {
            *number = Some(VertexId::from(kept.len()));
            kept.push(position(vertex));
        }
    }
    let renumbered = |face: &[VertexId; 3]| {
        let [a, b, c] = face.map(|v| number[v.index()]);
        Some([a?, b?, c?])
    };
    TriMesh { positions: kept, faces: input_faces.iter().filter_map(renumbered).collect() }
}
