//! Triangle meshes in space.

use nalgebra::{Matrix3, Point3, Vector3};
use surface::{EdgeGraph, IntrinsicMesh, Link, Topology, VertexId, power_of_two_below};

/// An indexed triangle mesh: vertex positions and faces, exactly as they were read.
///
/// Faces refer to existing vertices. Duplicate, degenerate, flipped and non-manifold faces, holes and several
/// components are all allowed: [`validate`](crate::validate) reports them and [`repair`](crate::repair())
/// removes what an algorithm cannot handle.
///
/// ```
/// use canonform_mesh::TriMesh;
/// use surface::VertexId;
///
/// let mesh = TriMesh {
///     positions: vec![[0.0, 0.0, 0.0].into(), [4.0, 0.0, 0.0].into(), [0.0, 3.0, 0.0].into()],
///     faces: vec![[0, 1, 2].map(VertexId)],
/// };
/// assert_eq!(mesh.area(), 6.0);
/// assert_eq!(mesh.intrinsic().edge_lengths(), [4.0, 3.0, 5.0]);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// Vertex positions, in mesh units.
    pub positions: Vec<Point3<f64>>,
    /// The three vertices of each face, counter-clockwise as seen from outside if the input is so.
    pub faces: Vec<[VertexId; 3]>,
}

impl TriMesh {
    /// Number of vertices.
    pub fn n_vertices(&self) -> usize {
        self.positions.len()
    }

    /// Number of faces.
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// The three corner positions of face `face`.
    pub fn triangle(&self, face: usize) -> [Point3<f64>; 3] {
        self.faces[face].map(|v| self.positions[v.index()])
    }

    /// The mesh with every vertex where a map takes it.
    pub fn moved(&self, map: impl FnMut(&Point3<f64>) -> Point3<f64>) -> Self {
        Self { positions: self.positions.iter().map(map).collect(), faces: self.faces.clone() }
    }

    /// The edges, for shortest paths along them; inner ones come twice.
    pub fn edge_graph(&self) -> EdgeGraph {
        let sides = self.faces.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let length = |[a, b]: [VertexId; 2]| (self.positions[b.index()] - self.positions[a.index()]).norm();
        EdgeGraph::new(self.n_vertices(), sides.map(|ends| Link { ends, length: length(ends) }))
    }

    /// The normal of face `face`; its length is twice the area of the face.
    pub fn area_vector(&self, face: usize) -> Vector3<f64> {
        self.area_vector_in(face, 1.0)
    }

    /// The same in squares of `unit`, whose products neither overflow nor vanish if it is [that of the mesh](Self::unit).
    pub(crate) fn area_vector_in(&self, face: usize, unit: f64) -> Vector3<f64> {
        let [a, b, c] = self.triangle(face);
        ((b - a) / unit).cross(&((c - a) / unit))
    }

    /// Sum of the areas of all faces, in squared mesh units.
    pub fn area(&self) -> f64 {
        self.face_areas().sum()
    }

    /// The area of every face, in squared mesh units; accurate at any scale.
    pub fn face_areas(&self) -> impl Iterator<Item = f64> {
        let unit = self.unit();
        (0..self.n_faces()).map(move |f| 0.5 * self.area_vector_in(f, unit).norm() * unit * unit)
    }

    /// The square root of the area, in mesh units; accurate also where the area is too small for a number.
    pub fn root_of_area(&self) -> f64 {
        let unit = self.unit();
        (0..self.n_faces()).map(|f| 0.5 * self.area_vector_in(f, unit).norm()).sum::<f64>().sqrt() * unit
    }

    /// The mesh without vertices that no face names; the others keep their order.
    pub fn without_unused_vertices(&self) -> Self {
        self.compacted().0
    }

    /// The mesh without vertices that no face names, and the number there of every other vertex.
    pub(crate) fn compacted(&self) -> (Self, Vec<Option<VertexId>>) {
        let mut is_used = vec![false; self.n_vertices()];
        self.faces.iter().flatten().for_each(|v| is_used[v.index()] = true);
        let mut positions = Vec::new();
        let mut number = vec![None; self.n_vertices()];
        for v in (0..self.n_vertices()).filter(|&v| is_used[v]) {
            number[v] = Some(VertexId::from(positions.len()));
            positions.push(self.positions[v]);
        }
        let renumbered = |face: &[VertexId; 3]| face.map(|v| number[v.index()].unwrap_or(v));
        (Self { positions, faces: self.faces.iter().map(renumbered).collect() }, number)
    }

    /// The volume that a closed surface encloses, in cubed mesh units; negative if its faces are turned inward.
    pub fn signed_volume(&self) -> f64 {
        let cone = |f| {
            let [a, b, c] = self.triangle(f);
            a.coords.dot(&b.coords.cross(&c.coords)) / 6.0
        };
        (0..self.n_faces()).map(cone).sum()
    }

    /// The centroid of the surface, and its second moments about it: the mean of `(x - c)(x - c)'` over the area, exact for
    /// flat faces.
    pub fn moments(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let (mut first, mut second, mut total) = (Vector3::zeros(), Matrix3::zeros(), 0.0);
        for (f, area) in self.face_areas().enumerate() {
            let corners = self.triangle(f).map(|p| p.coords);
            let sum: Vector3<f64> = corners.iter().sum();
            first += sum * (area / 3.0);
            let squares: Matrix3<f64> = corners.iter().map(|p| p * p.transpose()).sum();
            second += (squares + sum * sum.transpose()) * (area / 12.0);
            total += area;
        }
        let centroid = first / total;
        (centroid, second / total - centroid * centroid.transpose())
    }

    /// The lumped mass of each vertex, a third of the area of its faces, in squared mesh units.
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.n_vertices()];
        for (face, area) in self.faces.iter().zip(self.face_areas()) {
            for v in face {
                areas[v.index()] += area / 3.0;
            }
        }
        areas
    }

    /// The intrinsic geometry: connectivity and the length of every edge.
    ///
    /// # Panics
    /// If a face has a repeated vertex or one that does not exist, see [`Topology::new`];
    /// [`repair`](crate::repair()) removes such faces.
    pub fn intrinsic(&self) -> IntrinsicMesh {
        self.measured(self.topology())
    }

    /// The connectivity.
    ///
    /// # Panics
    /// As [`intrinsic`](Self::intrinsic).
    pub fn topology(&self) -> Topology {
        Topology::new(self.n_vertices(), self.faces.clone())
    }

    /// The intrinsic geometry, given the connectivity of the mesh.
    pub(crate) fn measured(&self, topology: Topology) -> IntrinsicMesh {
        let unit = self.unit();
        IntrinsicMesh::with_lengths(topology, |[a, b]| {
            ((self.positions[a.index()] - self.positions[b.index()]) / unit).norm() * unit
        })
    }

    /// The largest extent along an axis, in mesh units; zero without vertices, infinite if it cannot be represented.
    pub fn size(&self) -> f64 {
        self.bounds().map_or(0.0, |[lo, hi]| (hi - lo).max())
    }

    /// A unit of length near the size of the mesh, in mesh units: a power of two, so that dividing coordinates and
    /// lengths by it and multiplying them with it is exact. Products of lengths in units neither overflow nor vanish.
    pub fn unit(&self) -> f64 {
        power_of_two_below(self.size())
    }

    /// Lower and upper corner of the axis-aligned bounding box, in mesh units; `None` without vertices.
    pub fn bounds(&self) -> Option<[Point3<f64>; 2]> {
        bounds_of(&self.positions)
    }
}

/// As [`TriMesh::bounds`], of some points.
pub(crate) fn bounds_of<'a>(points: impl IntoIterator<Item = &'a Point3<f64>>) -> Option<[Point3<f64>; 2]> {
    let points = points.into_iter().map(|p| [*p, *p]);
    points.reduce(|[lo, hi], [low, high]| [lo.inf(&low), hi.sup(&high)])
}
