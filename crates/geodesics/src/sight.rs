//! What is seen from a point along straight lines.

use surface::{EdgeId, FaceId, IntrinsicMesh, SurfacePoint, VertexId};

use crate::flat::{Flat, faces_around};
use crate::plane::{GateSide, PlanePoint, between, beyond, cross, dot};

/// The rays from a point that cross one edge after the same faces, in the plane with that point in the origin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Rays {
    /// The number of the rays that they are part of.
    pub(crate) before: Option<usize>,
    /// The face that they cross, and the edge they leave it by.
    pub(crate) face: FaceId,
    pub(crate) edge: EdgeId,
    /// The left and the right end of the edge.
    pub(crate) gate: [(VertexId, PlanePoint); 2],
    /// Points on the outermost rays on either side.
    left: PlanePoint,
    right: PlanePoint,
}

/// A face that rays enter, in the same plane.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeenFace {
    pub(crate) face: FaceId,
    pub(crate) flat: Flat,
    /// Which of its vertices are seen through it first.
    pub(crate) is_visible: [bool; 3],
    /// The rays that leave it.
    pub(crate) onward: [Option<Rays>; 3],
}

/// The faces that hold a point, with the rays over all edges that it does not lie on.
pub(crate) fn faces_seen_from(mesh: &IntrinsicMesh, from: SurfacePoint) -> Vec<SeenFace> {
    let seen = |face: FaceId| {
        let flat = Flat::of_face(mesh, face).about(mesh, from);
        let onward = face.corners().map(|corner| {
            // Counter-clockwise, so that the first end is on the right from inside.
            let [right, left] = mesh.topology().edge_ends(corner).map(|v| (v, flat.vertex(v)));
            // From the apex of a flat face, they lie in opposite directions.
            let turn = cross(right.1, left.1);
            let is_ahead = turn > 0.0 || (turn == 0.0 && dot(right.1, left.1) < 0.0);
            let edge = mesh.topology().opposite_edge(corner);
            is_ahead.then_some(Rays {
                before: None,
                face,
                edge,
                gate: [left, right],
                left: left.1,
                right: right.1,
            })
        });
        let is_visible = flat.vertices.map(|v| SurfacePoint::Vertex(v) != from);
        SeenFace { face, flat, is_visible, onward }
    };
    faces_around(mesh, from).into_iter().map(seen).collect()
}

impl Rays {
    /// The faces beyond their edge; `number` is that of these rays.
    pub(crate) fn faces_beyond(self, mesh: &IntrinsicMesh, number: usize) -> impl Iterator<Item = SeenFace> {
        let topology = mesh.topology();
        let facing = topology.edge_corners(self.edge).iter().filter(move |corner| corner.face() != self.face);
        facing.map(move |facing| {
            let (face, third) = (facing.face(), topology.corner_vertex(*facing));
            let [(left, at_left), (right, at_right)] = self.gate;
            let edges = [facing.prev(), facing.next()].map(|third| topology.opposite_edge(third));
            let [to_left, to_right] =
                if topology.edges()[edges[0].index()].contains(&left) { edges } else { [edges[1], edges[0]] };
            let lengths = [self.edge, to_left, to_right].map(|edge| mesh.length(edge));
            let at = beyond([at_left, at_right], lengths, GateSide::Ahead);
            let flat = Flat { vertices: [left, right, third], at: [at_left, at_right, at] };
            let [from_left, from_right] = [cross(at, self.left), cross(self.right, at)];
            let is_visible = from_left >= 0.0 && from_right >= 0.0;
            let rays = Self { before: Some(number), face, ..self };
            // Some pass on the right of the vertex, some on the left.
            let on_right = (from_right > 0.0).then_some(Self {
                edge: to_right,
                gate: [(third, at), self.gate[1]],
                left: if is_visible { at } else { self.left },
                ..rays
            });
            let on_left = (from_left > 0.0).then_some(Self {
                edge: to_left,
                gate: [self.gate[0], (third, at)],
                right: if is_visible { at } else { self.right },
                ..rays
            });
            SeenFace { face, flat, is_visible: [false, false, is_visible], onward: [on_right, on_left, None] }
        })
    }

    /// Whether a point is among them.
    pub(crate) fn hold(&self, at: PlanePoint) -> bool {
        cross(at, self.left) >= 0.0 && cross(self.right, at) >= 0.0
    }

    /// The part of the edge that they cross, from left to right.
    pub(crate) fn span(&self) -> [PlanePoint; 2] {
        let [left, right] = self.gate.map(|(_, at)| at);
        [(self.left, 0.0), (self.right, 1.0)].map(|(ray, end)| {
            let share = crossing([left, right], ray);
            between(left, right, if share.is_nan() { end } else { share.clamp(0.0, 1.0) })
        })
    }

    /// Where the straight line to a point crosses the edge, from 0 at its lower vertex to 1 at its higher one.
    pub(crate) fn crossing_to(&self, at: PlanePoint) -> f64 {
        let [left, right] = self.gate;
        let share = crossing([left.1, right.1], at);
        // A line along the edge, or none at all, may take either end.
        let share = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
        if left.0 < right.0 { share } else { 1.0 - share }
    }
}

/// Where a ray from the origin crosses the line through two points, from 0 at the first to 1 at the second.
fn crossing([left, right]: [PlanePoint; 2], ray: PlanePoint) -> f64 {
    let (a, b) = (cross(ray, left), cross(ray, right));
    a / (a - b)
}
