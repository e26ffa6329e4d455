//! Sources: the points that distances are measured from.

use surface::{IntrinsicMesh, SurfacePoint, Triangle, VertexId};

use crate::error::{BadPoint, GeodesicError};

/// A point that distances are measured from, with its straight distances to the vertices of its own faces.
///
/// ```
/// use canonform_geodesics::{Source, SurfacePoint};
/// use mesh::shapes;
/// use surface::FaceId;
///
/// let mesh = shapes::icosphere(2).intrinsic();
/// let center = SurfacePoint::Face { face: FaceId(7), barycentric: [1.0 / 3.0; 3] };
/// let source = Source::new(&mesh, center)?;
/// assert_eq!(source.reach().len(), 3);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    point: SurfacePoint,
    reach: Vec<(VertexId, f64)>,
}

/// Rounding allowed in the sum of barycentric coordinates.
const BARYCENTRIC_SLACK: f64 = 1e-9;

impl Source {
    /// A vertex.
    pub fn vertex(vertex: VertexId) -> Self {
        Self { point: SurfacePoint::Vertex(vertex), reach: vec![(vertex, 0.0)] }
    }

    /// The same source of the same surface with all lengths divided by `unit`.
    pub(crate) fn in_units_of(&self, unit: f64) -> Self {
        Self { point: self.point, reach: self.reach.iter().map(|&(v, length)| (v, length / unit)).collect() }
    }

    /// Any point of a surface.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`] and [`GeodesicError::BadPoint`].
    pub fn new(mesh: &IntrinsicMesh, point: SurfacePoint) -> Result<Self, GeodesicError> {
        let topology = mesh.topology();
        match point {
            SurfacePoint::Vertex(vertex) if vertex.index() < mesh.n_vertices() => Ok(Self::vertex(vertex)),
            SurfacePoint::Vertex(vertex) => {
                Err(GeodesicError::NoSuchVertex { vertex, n_vertices: mesh.n_vertices() })
            }
            SurfacePoint::Edge { edge, t } => {
                if edge.index() >= topology.n_edges() {
                    return Err(BadPoint::NoEdge { edge, n_edges: topology.n_edges() }.into());
                }
                if !(0.0..=1.0).contains(&t) {
                    return Err(BadPoint::OffEdge { t }.into());
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
                    return Err(BadPoint::NoFace { face, n_faces: topology.n_faces() }.into());
                }
                let sum: f64 = barycentric.iter().sum();
                let whole = (1.0 - BARYCENTRIC_SLACK..=1.0 + BARYCENTRIC_SLACK).contains(&sum);
                if barycentric.iter().any(|b| *b < 0.0) || !whole {
                    return Err(BadPoint::OffFace { barycentric }.into());
                }
                let vertices = topology.faces()[face.index()];
                // The squared distance in the plane of the face from a point with barycentric coordinates b to corner
                // i is -sum_{j<k} e_j e_k |v_j v_k|^2 with e = b - unit_i.
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
    pub fn point(&self) -> SurfacePoint {
        self.point
    }

    /// The vertices of the faces that contain the point, with their distances from it inside these faces, in mesh
    /// units; of a vertex only itself.
    pub fn reach(&self) -> &[(VertexId, f64)] {
        &self.reach
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes::grid;
    use surface::{EdgeId, FaceId};

    #[test]
    fn points_off_the_surface_are_rejected() {
        let mesh = grid(2, 2, 1.0).intrinsic();
        for point in [
            SurfacePoint::Edge { edge: EdgeId(9), t: 0.5 },
            SurfacePoint::Edge { edge: EdgeId(0), t: 1.5 },
            SurfacePoint::Edge { edge: EdgeId(0), t: f64::NAN },
            SurfacePoint::Face { face: FaceId(2), barycentric: [1.0, 0.0, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [0.5, 0.0, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [1.5, -0.5, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [f64::NAN, 0.5, 0.5] },
        ] {
            assert!(matches!(Source::new(&mesh, point), Err(GeodesicError::BadPoint(_))), "{point:?}");
        }
        let vertex = SurfacePoint::Vertex(VertexId(4));
        assert!(matches!(Source::new(&mesh, vertex), Err(GeodesicError::NoSuchVertex { .. })));
    }
}
