//! The faces around a source in the plane.

use std::f64::consts::TAU;

use surface::{CornerId, EdgeId, FaceId, IntrinsicMesh, OneRing, SurfacePoint, VertexId, Winding};

use super::prepared::PreparedSurface;
use crate::flat::Flat;
use crate::plane::{PlanePoint, sub};

/// The faces around a point, unrolled into the plane that touches there.
#[derive(Debug)]
pub(super) struct TangentPlane {
    pub(super) sheets: Vec<Sheet>,
    /// The angle of the first axis.
    pub(super) zero: f64,
    /// From angles on the surface to those in the plane.
    pub(super) scale: f64,
}

/// A face of a tangent plane: it is laid out with the point in the origin, and an angle `a` there is `start + sign * a`.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) face: FaceId,
    pub(super) flat: Flat,
    pub(super) start: f64,
    pub(super) sign: f64,
}

impl TangentPlane {
    pub(super) fn at(mesh: &IntrinsicMesh, point: SurfacePoint) -> Self {
        match point {
            SurfacePoint::Vertex(vertex) => Self::at_vertex(mesh, vertex),
            SurfacePoint::Edge { edge, .. } => Self::at_edge(mesh, point, edge),
            SurfacePoint::Face { face, .. } => {
                let flat = Flat::of_face(mesh, face).about(mesh, point);
                Self { sheets: vec![Sheet { face, flat, start: 0.0, sign: 1.0 }], zero: 0.0, scale: 1.0 }
            }
        }
    }

    /// The first face of the edge lies on the side that its orientation says, all others on the other side.
    fn at_edge(mesh: &IntrinsicMesh, point: SurfacePoint, edge: EdgeId) -> Self {
        let [low, high] = mesh.topology().edges()[edge.index()];
        let mut first = None;
        let sheet = |corner: &CornerId| {
            // The corner opposite the edge is in the origin, and its face to the left of the side from the next corner on.
            let side = if mesh.topology().corner_vertex(corner.next()) == low { 1.0 } else { -1.0 };
            let wanted = first.map_or(side, |first: f64| -first);
            first = first.or(Some(side));
            let (sign, flat) = (wanted * side, Flat::new(mesh, *corner).about(mesh, point));
            let along = angle_of(sub(flat.vertex(high), flat.vertex(low)));
            Sheet { face: corner.face(), flat, start: -sign * along, sign }
        };
        Self { sheets: mesh.topology().edge_corners(edge).iter().map(sheet).collect(), zero: 0.0, scale: 1.0 }
    }

    fn at_vertex(mesh: &IntrinsicMesh, vertex: VertexId) -> Self {
        let topology = mesh.topology();
        let mut ring = OneRing::default();
        ring.collect(topology, vertex);
        let (mut sheets, mut sides, mut total) = (Vec::new(), Vec::new(), 0.0);
        let mut orientation = (CornerId(u32::MAX), 1.0);
        for corner in ring.fans().flat_map(|fan| fan.corners) {
            let flat = Flat::new(mesh, corner.corner);
            let [start, end] = [total, total + angle_of(flat.at[2])];
            total = end;
            let ends = [corner.opposite_last(), corner.opposite_first()].map(|c| topology.corner_vertex(c));
            sides.extend([(ends[0], start), (ends[1], end)]);
            let (start, sign) = match corner.winding {
                Winding::Forward => (start, 1.0),
                Winding::Backward => (end, -1.0),
            };
            if corner.corner < orientation.0 {
                orientation = (corner.corner, sign);
            }
            sheets.push(Sheet { face: corner.corner.face(), flat, start, sign });
        }
        let zero = sides.iter().min_by_key(|(end, _)| *end).map_or(0.0, |(_, angle)| *angle);
        let scale = orientation.1 * if ring.is_closed() && total > 0.0 { TAU / total } else { 1.0 };
        Self { sheets, zero, scale }
    }

    /// The same with the numbers of a prepared surface.
    pub(super) fn renumbered(mut self, surface: &PreparedSurface) -> Self {
        for Sheet { face, flat, .. } in &mut self.sheets {
            *face = FaceId(surface.new_faces[face.index()]);
            flat.vertices = flat.vertices.map(|v| VertexId(surface.new_vertices[v.index()]));
        }
        self
    }
}

impl Sheet {
    pub(super) fn place(&self, vertex: u32) -> Option<PlanePoint> {
        self.flat.vertices.iter().position(|v| v.0 == vertex).map(|slot| self.flat.at[slot])
    }
}

pub(super) fn angle_of([x, y]: PlanePoint) -> f64 {
    y.atan2(x)
}
