//! Triangle meshes in space.

use nalgebra::{Point3, Vector3};

use surface::{IntrinsicMesh, Topology, VertexId};

/// An indexed triangle mesh: vertex positions and faces, exactly as they were read.
///
/// Nothing is assumed of the faces beyond indices in range: duplicate, degenerate, flipped and
/// non-manifold faces, holes and several components are all allowed. [`validate`](crate::validate)
/// reports them and [`repair`](crate::repair()) mends what an algorithm cannot take.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TriMesh {
    /// Vertex positions, in mesh units.
    pub positions: Vec<Point3<f64>>,
    /// The three vertices of each face, counter-clockwise seen from outside where the input says so.
    pub faces: Vec<[VertexId; 3]>,
}

impl TriMesh {
    /// Number of vertices.
    #[must_use]
    pub fn n_vertices(&self) -> usize {
        self.positions.len()
    }

    /// Number of faces.
    #[must_use]
    pub fn n_faces(&self) -> usize {
        self.faces.len()
    }

    /// The three corner positions of face `face`.
    #[must_use]
    pub fn triangle(&self, face: usize) -> [Point3<f64>; 3] {
        self.faces[face].map(|v| self.positions[v.index()])
    }

    /// Normal of face `face` whose length is twice the face's area.
    #[must_use]
    pub fn area_vector(&self, face: usize) -> Vector3<f64> {
        let [a, b, c] = self.triangle(face);
        (b - a).cross(&(c - a))
    }

    /// Sum of the areas of all faces, in squared mesh units.
    #[must_use]
    pub fn area(&self) -> f64 {
        (0..self.n_faces()).map(|f| 0.5 * self.area_vector(f).norm()).sum()
    }

    /// A third of the area of the faces around each vertex (the lumped mass), in squared mesh units.
    #[must_use]
    pub fn vertex_areas(&self) -> Vec<f64> {
        let mut areas = vec![0.0; self.n_vertices()];
        for (f, face) in self.faces.iter().enumerate() {
            let third = self.area_vector(f).norm() / 6.0;
            for v in face {
                areas[v.index()] += third;
            }
        }
        areas
    }

    /// The intrinsic geometry: connectivity and the length of every edge.
    ///
    /// # Panics
    /// When a face is degenerate in its indices or out of range, see [`Topology::new`]; [`repair`](crate::repair())
    /// removes such faces.
    #[must_use]
    pub fn intrinsic(&self) -> IntrinsicMesh {
        let topology = Topology::new(self.n_vertices(), self.faces.clone());
        let length = |[a, b]: &[VertexId; 2]| (self.positions[a.index()] - self.positions[b.index()]).norm();
        let lengths = topology.edges().iter().map(length).collect();
        IntrinsicMesh::new(topology, lengths)
    }

    /// Lower and upper corner of the axis-aligned bounding box; `None` without vertices.
    #[must_use]
    pub fn bounds(&self) -> Option<[Point3<f64>; 2]> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold([first, first], |[lo, hi], p| [lo.inf(p), hi.sup(p)]))
    }
}
