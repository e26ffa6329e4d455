//! The angle of a path at a vertex, and the faces on its inner side.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use surface::{CornerId, EdgeId, FaceId, IntrinsicMesh, NearestFirst, VertexId};

use super::plane::{Flat, is_on};
use super::strip::Portal;
use surface::SurfacePoint;

/// A path bends if the angle on one side is less than this: smaller bends are rounding.
const STRAIGHT: f64 = PI - 1e-8;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Direction {
    Along(EdgeId),
    /// Into a face, at these angles from its two edges at the vertex.
    Into {
        face: FaceId,
        edges: [EdgeId; 2],
        angles: [f64; 2],
    },
}

/// The direction from `vertex` into a face, towards a portal or, without one, the point `end` in it.
pub(super) fn direction(
    mesh: &IntrinsicMesh,
    vertex: VertexId,
    face: FaceId,
    portal: Option<&Portal>,
    end: SurfacePoint,
) -> Option<Direction> {
    let towards = portal.map_or(end, |portal| portal.point());
    let topology = mesh.topology();
    let corner = topology.corner_at(face, vertex)?;
    let edges = topology.corner_edges(corner);
    if let Some(edge) = edges.into_iter().find(|edge| is_on(mesh, towards, *edge)) {
        return Some(Direction::Along(edge));
    }
    let [x, y] = Flat::new(mesh, corner).point(mesh, towards);
    // Rounding may put the point outside the face, but angles must not be negative.
    let first = y.atan2(x).abs();
    let rest = (angle(mesh, corner) - first).abs();
    Some(Direction::Into { face, edges, angles: [first, rest] })
}

/// The faces between two directions at a vertex, and the edges between these faces, on a side where the directions
/// are less than 180 degrees apart; `None` if both sides have more. A path is shorter past the vertex on that side.
///
/// Finds the shortest path in a graph whose nodes are the edges at the vertex and whose arcs are the angles of faces.
/// So edges may have any number of faces of any orientation, and the fan may be open.
///
/// Cost: `O(k log k)` for the `k` faces within 180 degrees.
pub(super) fn inner_side(
    mesh: &IntrinsicMesh,
    vertex: VertexId,
    from: Direction,
    to: Direction,
) -> Option<(Vec<FaceId>, Vec<EdgeId>)> {
    let topology = mesh.topology();
    // For each edge: the angle to it, and the edge before it and the face between, if any.
    let mut reached: BTreeMap<EdgeId, (f64, Option<EdgeId>, Option<FaceId>)> = BTreeMap::new();
    let mut queue = NearestFirst::default();
    let mut best: (f64, Option<EdgeId>) = (STRAIGHT, None);
    match from {
        Direction::Along(edge) => {
            reached.insert(edge, (0.0, None, None));
            queue.push(0.0, edge);
        }
        Direction::Into { face, edges, angles } => {
            for (edge, angle) in edges.into_iter().zip(angles) {
                reached.insert(edge, (angle, None, Some(face)));
                queue.push(angle, edge);
            }
        }
    }
    if let (Direction::Into { face, angles: a, .. }, Direction::Into { face: other, angles: b, .. }) =
        (from, to)
        && face == other
        && (a[0] - b[0]).abs() < best.0
    {
        return Some((vec![face], Vec::new()));
    }
    while let Some((here, edge)) = queue.pop() {
        if here >= best.0 {
            break;
        }
        if reached.get(&edge).is_some_and(|known| known.0 < here) {
            continue;
        }
        let rest = match to {
            Direction::Along(last) => (last == edge).then_some(0.0),
            Direction::Into { edges, angles, .. } => {
                edges.iter().position(|last| *last == edge).map(|i| angles[i])
            }
        };
        if let Some(rest) = rest.filter(|rest| here + rest < best.0) {
            best = (here + rest, Some(edge));
        }
        for facing in topology.edge_corners(edge) {
            let Some(corner) = topology.corner_at(facing.face(), vertex) else { continue };
            let there = here + angle(mesh, corner);
            for next in topology.corner_edges(corner).into_iter().filter(|next| *next != edge) {
                if there < STRAIGHT && reached.get(&next).is_none_or(|known| there < known.0) {
                    reached.insert(next, (there, Some(edge), Some(facing.face())));
                    queue.push(there, next);
                }
            }
        }
    }
    let mut at = best.1;
    let (mut faces, mut edges) = (Vec::new(), Vec::new());
    if let Direction::Into { face, .. } = to {
        faces.push(face);
    }
    at?;
    while let Some((edge, (_, before, face))) = at.and_then(|edge| Some((edge, *reached.get(&edge)?))) {
        edges.push(edge);
        faces.extend(face);
        at = before;
    }
    faces.reverse();
    edges.reverse();
    // Edges along which the path arrives or leaves are not crossed.
    if matches!(to, Direction::Along(_)) {
        edges.pop();
    }
    if matches!(from, Direction::Along(_)) && !edges.is_empty() {
        edges.remove(0);
    }
    if faces.is_empty() {
        // Back along the same edge.
        faces.push(topology.edge_corners(best.1?).first()?.face());
    }
    Some((faces, edges))
}

fn angle(mesh: &IntrinsicMesh, corner: CornerId) -> f64 {
    let [_, _, [x, y]] = Flat::new(mesh, corner).at;
    y.atan2(x)
}
