//! The properties and defects of a mesh.

mod fans;

use nalgebra::{Point3, Vector3};
use serde::Serialize;
use surface::{EdgeId, Topology, VertexId, components_of_faces};

use crate::coincidence::coincident_pairs;
use crate::face_set::{remove_degenerate, without_duplicates};
use crate::orientation::{Orientation, has_same_direction};
use crate::tri_mesh::{TriMesh, bounds_of};

/// The properties and defects of a mesh, from [`validate`].
///
/// Connectivity (from `n_edges` to `genus`) leaves out degenerate and duplicate faces:
/// [`repair()`](crate::repair()) always removes them, and they would count again as non-manifold edges.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MeshReport {
    /// Vertices in the file, used by a face or not.
    pub n_vertices: usize,
    /// Faces in the file.
    pub n_faces: usize,
    /// Faces with a repeated vertex.
    pub degenerate_faces: usize,
    /// Faces with the same three vertices as an earlier one.
    pub duplicate_faces: usize,
    /// Faces with three distinct vertices whose height is below 1e-12 of their longest side. Repair keeps
    /// them unless two corners are in the same position.
    pub zero_area_faces: usize,
    /// Vertices without a face.
    pub unreferenced_vertices: usize,
    /// Vertices in exactly the position of an earlier one.
    pub duplicate_vertices: usize,

    /// Undirected edges.
    pub n_edges: usize,
    /// Connected components.
    pub n_components: usize,
    /// Number of faces of each component, in the order of their lowest vertices.
    pub component_faces: Vec<usize>,
    /// Edges with one face.
    pub n_boundary_edges: usize,
    /// Closed chains of boundary edges, or open ones where the boundary meets a non-manifold edge.
    pub n_boundary_loops: usize,
    /// Edges with three faces or more.
    pub non_manifold_edges: usize,
    /// Vertices whose faces form more than one fan.
    pub non_manifold_vertices: usize,
    /// Edges that their two faces traverse in the same direction: one of the faces is flipped.
    pub inconsistent_edges: usize,
    /// The fewest faces to flip so that neighbors across manifold edges are oriented consistently.
    pub flipped_faces: usize,
    /// Whether neighbors across manifold edges can be oriented consistently.
    pub orientable: bool,
    /// Vertices with a face, minus edges, plus faces.
    pub euler_characteristic: i64,
    /// Number of handles of a closed, connected, orientable manifold; `None` otherwise.
    pub genus: Option<u64>,

    /// Share of faces with an angle above 90 degrees among those that are not degenerate, 0 to 1.
    pub obtuse_share: f64,
    /// Length of the shortest edge, in mesh units; zero without edges.
    pub min_edge_length: f64,
    /// Mean length of edges, in mesh units; zero without edges.
    pub mean_edge_length: f64,
    /// Length of the longest edge, in mesh units; zero without edges.
    pub max_edge_length: f64,
    /// Sum of the areas of all faces but duplicates, in squared mesh units.
    pub area: f64,
    /// Lengths of the sides of the axis-aligned bounding box of all faces, in mesh units.
    pub size: [f64; 3],
    /// Its diagonal.
    pub bounding_box_diagonal: f64,
    /// What the faces enclose, in cubed mesh units, if they close it and are oriented consistently.
    pub volume: Option<f64>,
}

/// Inspects a mesh, whatever its defects. Linear time but for one sort of the vertices.
///
/// # Panics
/// If a face refers to a vertex that does not exist; readers return no such mesh.
///
/// ```
/// use canonform_mesh::{shapes, validate};
///
/// let mut sheet = shapes::grid(4, 3, 2.0);
/// sheet.faces.push(sheet.faces[0]);
/// let report = validate(&sheet);
/// assert_eq!((report.duplicate_faces, report.n_boundary_loops, report.area), (1, 1, 24.0));
/// ```
pub fn validate(mesh: &TriMesh) -> MeshReport {
    let n_vertices = mesh.n_vertices();
    let unit = mesh.unit();
    let corners = mesh.faces.iter().flatten().map(|v| &mesh.positions[v.index()]);
    let size = bounds_of(corners).map_or(Vector3::zeros(), |[low, high]| high - low);
    let mut faces = mesh.faces.clone();
    let degenerate_faces = remove_degenerate(&mut faces);
    let mut referenced = vec![false; n_vertices];
    mesh.faces.iter().flatten().for_each(|v| referenced[v.index()] = true);
    let (topology, duplicate_faces) = without_duplicates(n_vertices, faces);
    let n_faces = topology.n_faces();
    let components = components_of_faces(topology.n_vertices(), topology.faces());
    let mut component_faces = vec![0; components.count];
    topology.faces().iter().filter_map(|f| components.of(f[0])).for_each(|c| component_faces[c] += 1);
    let orientation = Orientation::of(&topology);
    let n_used = components.labels.iter().flatten().count();
    let mut report = MeshReport {
        n_vertices,
        n_faces: mesh.n_faces(),
        degenerate_faces,
        duplicate_faces,
        unreferenced_vertices: referenced.iter().filter(|&&r| !r).count(),
        duplicate_vertices: coincident_pairs(&mesh.positions, 0..n_vertices as u32).len(),
        n_edges: topology.n_edges(),
        n_components: components.count,
        component_faces,
        flipped_faces: orientation.turned.iter().filter(|&&t| t).count(),
        orientable: orientation.orientable.iter().all(|&o| o),
        euler_characteristic: n_used as i64 - topology.n_edges() as i64 + n_faces as i64,
        size: size.into(),
        bounding_box_diagonal: (size / unit).norm() * unit,
        ..MeshReport::default()
    };
    report.add_faces(&mesh.positions, unit, topology.faces());
    report.add_edges(&mesh.positions, unit, &topology);
    report.add_fans(&topology);
    let n_defects = report.n_boundary_edges + report.non_manifold_edges + report.non_manifold_vertices;
    let is_closed = report.orientable && n_defects == 0;
    let encloses = is_closed && report.inconsistent_edges == 0 && n_faces == mesh.n_faces() && n_faces > 0;
    report.volume = encloses.then(|| mesh.signed_volume().abs()).filter(|volume| volume.is_finite());
    report.genus = (is_closed && report.n_components == 1)
        .then_some((2 - report.euler_characteristic).unsigned_abs() / 2);
    report
}

impl MeshReport {
    fn add_faces(&mut self, positions: &[Point3<f64>], unit: f64, faces: &[[VertexId; 3]]) {
        /// Ratio of height to longest side below which a face has no area: some thousand rounding errors.
        const FLAT: f64 = 1e-12;
        let mut n_obtuse = 0;
        for face in faces {
            let [a, b, c] = face.map(|v| positions[v.index()] / unit);
            let sides = [b - a, c - b, a - c];
            let twice_area = sides[0].cross(&sides[1]).norm();
            let longest = sides.iter().fold(0.0, |longest, s| f64::max(longest, s.norm_squared()));
            // The sides form a cycle, so two that meet in an obtuse corner have a positive product.
            n_obtuse += usize::from((0..3).any(|i| sides[i].dot(&sides[(i + 1) % 3]) > 0.0));
            self.zero_area_faces += usize::from(twice_area <= FLAT * longest);
            self.area += 0.5 * twice_area * unit * unit;
        }
        self.obtuse_share = n_obtuse as f64 / faces.len().max(1) as f64;
    }

    fn add_edges(&mut self, positions: &[Point3<f64>], unit: f64, topology: &Topology) {
        let (mut shortest, mut sum) = (f64::INFINITY, 0.0);
        for (e, [a, b]) in topology.edges().iter().enumerate() {
            match *topology.edge_corners(EdgeId::from(e)) {
                [_] => self.n_boundary_edges += 1,
                [a, b] => self.inconsistent_edges += usize::from(has_same_direction(topology, a, b)),
                _ => self.non_manifold_edges += 1,
            }
            let length = ((positions[a.index()] - positions[b.index()]) / unit).norm() * unit;
            shortest = length.min(shortest);
            self.max_edge_length = length.max(self.max_edge_length);
            sum += length;
        }
        if topology.n_edges() > 0 {
            self.min_edge_length = shortest;
            self.mean_edge_length = sum / topology.n_edges() as f64;
        }
    }
}
