//! Where distances start.

use surface::{EdgeId, FaceId, IntrinsicMesh, Triangle, VertexId};

use crate::GeodesicError;

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfacePoint {
    /// A vertex.
    Vertex(VertexId),
    /// The point `(1 - t) a + t b` on the edge with ends `a < b`; `t` in 0..=1.
    Edge {
        /// The edge.
        edge: EdgeId,
        /// Share of the way from the lower to the higher vertex.
        t: f64,
    },
    /// A point of a face.
    Face {
        /// The face.
        face: FaceId,
        /// Its barycentric coordinates: not negative, summing to one.
        barycentric: [f64; 3],
    },
}

impl std::fmt::Display for SurfacePoint {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Vertex(vertex) => write!(f, "vertex {vertex}"),
            Self::Edge { edge, t } => write!(f, "edge {edge} at {t}"),
            Self::Face { face, barycentric: [a, b, c] } => write!(f, "face {face} at {a}, {b}, {c}"),
        }
    }
}

/// A point from which distances are measured, and the vertices it sees within its own faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    point: SurfacePoint,
    reach: Vec<(VertexId, f64)>,
}

/// How far barycentric coordinates may be from summing to one, for the rounding of their writer.
const BARYCENTRIC_SLACK: f64 = 1e-9;

impl Source {
    /// A vertex.
    #[must_use]
    pub fn vertex(vertex: VertexId) -> Self {
        Self { point: SurfacePoint::Vertex(vertex), reach: vec![(vertex, 0.0)] }
    }

    /// Any point of a surface.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`] and [`GeodesicError::BadPoint`].
    pub fn new(mesh: &IntrinsicMesh, point: SurfacePoint) -> Result<Self, GeodesicError> {
        let topology = mesh.topology();
        let bad = |reason: String| GeodesicError::BadPoint { reason };
        match point {
            SurfacePoint::Vertex(vertex) if vertex.index() < mesh.n_vertices() => Ok(Self::vertex(vertex)),
            SurfacePoint::Vertex(vertex) => {
                Err(GeodesicError::NoSuchVertex { vertex, n_vertices: mesh.n_vertices() })
            }
            SurfacePoint::Edge { edge, t } => {
                if edge.index() >= topology.n_edges() {
                    return Err(bad(format!("edge {edge} of {}", topology.n_edges())));
                }
                if !(0.0..=1.0).contains(&t) {
                    return Err(bad(format!("the share {t} of an edge is not in 0..=1")));
                }
                let length = mesh.length(edge);
                let [a, b] = topology.edges()[edge.index()];
                let mut reach = vec![(a, t * length), (b, (1.0 - t) * length)];
                for corner in topology.edge_corners(edge) {
                    let mut sides = mesh.sides(*corner);
                    if topology.corner_vertex(corner.next()) != a {
                        sides.swap(1, 2);
                    }
                    let triangle = Triangle::from_sides(sides);
                    let apex = topology.corner_vertex(*corner);
                    reach.push((apex, (triangle.x - t * length).hypot(triangle.y)));
                }
                Ok(Self { point, reach })
            }
            SurfacePoint::Face { face, barycentric } => {
                if face.index() >= topology.n_faces() {
                    return Err(bad(format!("face {face} of {}", topology.n_faces())));
                }
                let sum: f64 = barycentric.iter().sum();
                let whole = (1.0 - BARYCENTRIC_SLACK..=1.0 + BARYCENTRIC_SLACK).contains(&sum);
                if barycentric.iter().any(|b| *b < 0.0) || !whole {
                    return Err(bad(format!(
                        "barycentric coordinates {barycentric:?} are negative or do not sum to 1"
                    )));
                }
                let vertices = topology.faces()[face.index()];
                // In the plane of the face: the squared distance from a point with barycentric
                // coordinates b to corner i is -sum_{j<k} e_j e_k |v_j v_k|^2 with e = b - unit_i.
                let sides = face.corners().map(|corner| mesh.opposite_length(corner).powi(2));
                let reach = [0, 1, 2].map(|i| {
                    let mut e = barycentric;
                    e[i] -= 1.0;
                    let sq = -(e[1] * e[2] * sides[0] + e[2] * e[0] * sides[1] + e[0] * e[1] * sides[2]);
                    (vertices[i], sq.max(0.0).sqrt())
                });
                Ok(Self { point, reach: reach.to_vec() })
            }
        }
    }

    /// The point.
    #[must_use]
    pub fn point(&self) -> SurfacePoint {
        self.point
    }

    /// The vertices of the faces that hold the point and their distances from it inside these
    /// faces, in mesh units; for a vertex only itself.
    #[must_use]
    pub fn reach(&self) -> &[(VertexId, f64)] {
        &self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use surface::Topology;

    /// Two right triangles over the unit square.
    fn square() -> IntrinsicMesh {
        let faces = [[0, 1, 2], [0, 2, 3]].map(|f: [u32; 3]| f.map(VertexId)).to_vec();
        let topology = Topology::new(4, faces);
        let at = [[0.0f64, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let length = |[a, b]: &[VertexId; 2]| {
            let (p, q) = (at[a.index()], at[b.index()]);
            (p[0] - q[0]).hypot(p[1] - q[1])
        };
        let lengths = topology.edges().iter().map(length).collect();
        IntrinsicMesh::new(topology, lengths)
    }

    #[test]
    fn reach_is_the_planar_distance() {
        let mesh = square();
        let face = SurfacePoint::Face { face: FaceId(0), barycentric: [0.2, 0.5, 0.3] };
        // The point is (0.8, 0.3).
        let expected = [0.8f64.hypot(0.3), 0.2f64.hypot(0.3), 0.2f64.hypot(0.7)];
        for ((_, d), e) in Source::new(&mesh, face).unwrap().reach().iter().zip(expected) {
            assert!((d - e).abs() < 1e-15);
        }
        let diagonal = mesh.topology().edge_between(VertexId(0), VertexId(2)).unwrap();
        let on_edge = Source::new(&mesh, SurfacePoint::Edge { edge: diagonal, t: 0.25 }).unwrap();
        // The point is (0.25, 0.25).
        let (near, side) = (0.25 * 2f64.sqrt(), 0.25f64.hypot(0.75));
        let expected = [(0, near), (2, 3.0 * near), (1, side), (3, side)];
        assert_eq!(on_edge.reach().len(), 4);
        for ((v, d), (w, e)) in on_edge.reach().iter().zip(expected) {
            assert!(v.0 == w && (d - e).abs() < 1e-15);
        }
    }

    #[test]
    fn points_off_the_surface_are_refused() {
        let mesh = square();
        for point in [
            SurfacePoint::Edge { edge: EdgeId(9), t: 0.5 },
            SurfacePoint::Edge { edge: EdgeId(0), t: 1.5 },
            SurfacePoint::Edge { edge: EdgeId(0), t: f64::NAN },
            SurfacePoint::Face { face: FaceId(2), barycentric: [1.0, 0.0, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [0.5, 0.0, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [1.5, -0.5, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [f64::NAN, 0.5, 0.5] },
        ] {
            assert!(matches!(Source::new(&mesh, point), Err(GeodesicError::BadPoint { .. })), "{point:?}");
        }
        let vertex = SurfacePoint::Vertex(VertexId(4));
        assert!(matches!(Source::new(&mesh, vertex), Err(GeodesicError::NoSuchVertex { .. })));
    }
}
