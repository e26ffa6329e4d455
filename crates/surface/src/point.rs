//! Points of a surface.

use crate::{EdgeId, FaceId, IntrinsicMesh, VertexId};

/// A point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SurfacePoint {
    /// A vertex.
    Vertex(VertexId),
    /// The point `(1 - t) a + t b` on the edge with ends `a < b`.
    Edge {
        /// The edge.
        edge: EdgeId,
        /// Position along the edge, from 0 at the lower vertex to 1 at the higher one.
        t: f64,
    },
    /// A point of a face.
    Face {
        /// The face.
        face: FaceId,
        /// Its barycentric coordinates: not negative, with sum 1.
        barycentric: [f64; 3],
    },
}

/// Positions and coordinates below this are rounding: the point lies on the edge, or is its end.
const ROUNDING: f64 = 1e-12;

impl SurfacePoint {
    /// The same point as a vertex if it is one, else as a point of an edge if it is on one, up to rounding.
    #[must_use]
    pub fn simplified(self, mesh: &IntrinsicMesh) -> Self {
        let topology = mesh.topology();
        match self {
            Self::Edge { edge, t } if t.min(1.0 - t) < ROUNDING => {
                Self::Vertex(topology.edges()[edge.index()][usize::from(t > 0.5)])
            }
            Self::Face { face, barycentric } => {
                let zero = face.corners().into_iter().find(|corner| barycentric[corner.slot()] < ROUNDING);
                let Some(corner) = zero else { return self };
                let edge = topology.opposite_edge(corner);
                let higher = topology.corner_at(face, topology.edges()[edge.index()][1]);
                let t = higher.map_or(0.0, |corner| barycentric[corner.slot()]);
                Self::Edge { edge, t }.simplified(mesh)
            }
            _ => self,
        }
    }
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
