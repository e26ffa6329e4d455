//! Faces laid out in the plane, and the points in them.

use surface::{CornerId, EdgeId, FaceId, IntrinsicMesh, SurfacePoint, VertexId};

use crate::plane::{PlanePoint, apex, between, distance, sub};

/// A face laid out in the plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Flat {
    pub(crate) vertices: [VertexId; 3],
    pub(crate) at: [PlanePoint; 3],
}

impl Flat {
    /// The face of a corner, with that corner in the origin and the next one on the x-axis.
    pub(crate) fn new(mesh: &IntrinsicMesh, corner: CornerId) -> Self {
        let corners = [corner, corner.next(), corner.prev()];
        let sides = mesh.sides(corner.prev());
        let vertices = corners.map(|corner| mesh.topology().corner_vertex(corner));
        Self { vertices, at: [[0.0, 0.0], [sides[0], 0.0], apex(sides)] }
    }

    /// A face with its first corner in the origin.
    pub(crate) fn of_face(mesh: &IntrinsicMesh, face: FaceId) -> Self {
        Self::new(mesh, CornerId::new(face, 0))
    }

    /// The same with a point of the face in the origin.
    pub(crate) fn about(self, mesh: &IntrinsicMesh, point: SurfacePoint) -> Self {
        let origin = self.point(mesh, point);
        Self { at: self.at.map(|at| sub(at, origin)), ..self }
    }

    pub(crate) fn vertex(&self, vertex: VertexId) -> PlanePoint {
        self.at[self.vertices.iter().position(|v| *v == vertex).unwrap_or_default()]
    }

    pub(crate) fn point(&self, mesh: &IntrinsicMesh, point: SurfacePoint) -> PlanePoint {
        match point {
            SurfacePoint::Vertex(vertex) => self.vertex(vertex),
            SurfacePoint::Edge { edge, t } => {
                let [a, b] = mesh.topology().edges()[edge.index()].map(|v| self.vertex(v));
                between(a, b, t)
            }
            SurfacePoint::Face { face, barycentric } => {
                let corners = mesh.topology().faces()[face.index()].map(|v| self.vertex(v));
                [0, 1].map(|axis| (0..3).map(|i| barycentric[i] * corners[i][axis]).sum())
            }
        }
    }
}

/// The faces that contain a point.
pub(crate) fn faces_around(mesh: &IntrinsicMesh, point: SurfacePoint) -> Vec<FaceId> {
    let faces = |corners: &[CornerId]| corners.iter().map(|corner| corner.face()).collect();
    match point {
        SurfacePoint::Vertex(vertex) => faces(mesh.topology().vertex_corners(vertex)),
        SurfacePoint::Edge { edge, .. } => faces(mesh.topology().edge_corners(edge)),
        SurfacePoint::Face { face, .. } => vec![face],
    }
}

/// The length of the straight line between two points of a face.
pub(crate) fn segment(mesh: &IntrinsicMesh, face: FaceId, p: SurfacePoint, q: SurfacePoint) -> f64 {
    let along = |edge: EdgeId, point| match point {
        SurfacePoint::Vertex(v) => {
            mesh.topology().edges()[edge.index()].iter().position(|end| *end == v).map(|end| end as f64)
        }
        SurfacePoint::Edge { edge: other, t } => (other == edge).then_some(t),
        SurfacePoint::Face { .. } => None,
    };
    // Two points on one edge need no layout, and flat faces cost no accuracy.
    for corner in face.corners() {
        let edge = mesh.topology().opposite_edge(corner);
        if let (Some(s), Some(t)) = (along(edge, p), along(edge, q)) {
            return (s - t).abs() * mesh.length(edge);
        }
    }
    let flat = Flat::of_face(mesh, face);
    distance(flat.point(mesh, p), flat.point(mesh, q))
}
