//! How a way turns at a vertex.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};
use std::f64::consts::PI;

use surface::{CornerId, EdgeId, FaceId, IntrinsicMesh, VertexId};

use super::plane::Flat;
use super::strip::{Portal, Strip};
use crate::SurfacePoint;

/// A way that turns by less than half a turn minus this much bends; what it would gain from less is
/// lost in rounding.
const STRAIGHT: f64 = PI - 1e-8;

/// A direction at a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Direction {
    /// Along an edge.
    Spoke(EdgeId),
    /// Into a face, at these angles from its two edges at the vertex.
    Inside { face: FaceId, spokes: [EdgeId; 2], angles: [f64; 2] },
}

/// Which end of a strip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum At {
    Start,
    End,
}

/// The faces on the inner side of a bend, and the edges between them.
pub(super) type Fan = (Vec<FaceId>, Vec<EdgeId>);

/// The direction in which a strip leaves `vertex`, which is one of its ends; `other` is the other end.
pub(super) fn direction(
    mesh: &IntrinsicMesh,
    vertex: VertexId,
    strip: &Strip,
    at: At,
    other: SurfacePoint,
) -> Option<Direction> {
    let (face, portal) = match at {
        At::Start => (strip.faces.first()?, strip.portals.first()),
        At::End => (strip.faces.last()?, strip.portals.last()),
    };
    let towards = portal.map_or(other, |portal: &Portal| portal.point());
    let topology = mesh.topology();
    let corner = topology.corner_at(*face, vertex)?;
    let spokes = topology.corner_edges(corner);
    let on = |spoke: &&EdgeId| match towards {
        SurfacePoint::Vertex(v) => topology.edges()[spoke.index()].contains(&v),
        SurfacePoint::Edge { edge, .. } => edge == **spoke,
        SurfacePoint::Face { .. } => false,
    };
    if let Some(spoke) = spokes.iter().find(on) {
        return Some(Direction::Spoke(*spoke));
    }
    let [x, y] = Flat::new(mesh, *face, corner.slot()).point(mesh, towards);
    // Rounding may take the point out of the face, and its angles are not to be negative.
    let first = y.atan2(x).abs();
    let rest = (angle(mesh, corner) - first).abs();
    Some(Direction::Inside { face: *face, spokes, angles: [first, rest] })
}

/// The faces between two directions at a vertex on the side where they are less than half a turn
/// apart, if there is such a side: a way that comes and goes there is shorter past the vertex.
///
/// The directions at a vertex are the points of a graph whose nodes are the edges at the vertex and
/// whose arcs are the angles of faces; it is searched for the shortest way. So it does not matter how
/// many faces an edge has, how they are oriented, or whether they go all the way round.
///
/// Cost: `O(k log k)` for the `k` faces within half a turn.
pub(super) fn inner_side(
    mesh: &IntrinsicMesh,
    vertex: VertexId,
    from: Direction,
    to: Direction,
) -> Option<Fan> {
    let topology = mesh.topology();
    // For each edge: the angle to it, and the edge before it and the face between, if any.
    let mut reached: BTreeMap<EdgeId, (f64, Option<EdgeId>, Option<FaceId>)> = BTreeMap::new();
    let mut queue = BinaryHeap::new();
    let mut best: (f64, Option<EdgeId>) = (STRAIGHT, None);
    match from {
        Direction::Spoke(spoke) => {
            reached.insert(spoke, (0.0, None, None));
            queue.push(Reverse((0, spoke)));
        }
        Direction::Inside { face, spokes, angles } => {
            for (spoke, angle) in spokes.into_iter().zip(angles) {
                reached.insert(spoke, (angle, None, Some(face)));
                queue.push(Reverse((angle.to_bits(), spoke)));
            }
        }
    }
    if let (Direction::Inside { face, angles: a, .. }, Direction::Inside { face: other, angles: b, .. }) =
        (from, to)
        && face == other
        && (a[0] - b[0]).abs() < best.0
    {
        return Some((vec![face], Vec::new()));
    }
    // Angles are not negative, so that their bits are in their order.
    while let Some(Reverse((bits, spoke))) = queue.pop() {
        let here = f64::from_bits(bits);
        if here >= best.0 {
            break;
        }
        if reached.get(&spoke).is_some_and(|known| known.0 < here) {
            continue;
        }
        let rest = match to {
            Direction::Spoke(last) => (last == spoke).then_some(0.0),
            Direction::Inside { spokes, angles, .. } => {
                spokes.iter().position(|last| *last == spoke).map(|i| angles[i])
            }
        };
        if let Some(rest) = rest.filter(|rest| here + rest < best.0) {
            best = (here + rest, Some(spoke));
        }
        for facing in topology.edge_corners(spoke) {
            let Some(corner) = topology.corner_at(facing.face(), vertex) else { continue };
            let there = here + angle(mesh, corner);
            for next in topology.corner_edges(corner).into_iter().filter(|next| *next != spoke) {
                if there < STRAIGHT && reached.get(&next).is_none_or(|known| there < known.0) {
                    reached.insert(next, (there, Some(spoke), Some(facing.face())));
                    queue.push(Reverse((there.to_bits(), next)));
                }
            }
        }
    }
    let mut at = best.1;
    let (mut faces, mut spokes) = (Vec::new(), Vec::new());
    if let Direction::Inside { face, .. } = to {
        faces.push(face);
    }
    at?;
    while let Some((spoke, (_, before, face))) = at.and_then(|spoke| Some((spoke, *reached.get(&spoke)?))) {
        spokes.push(spoke);
        faces.extend(face);
        at = before;
    }
    faces.reverse();
    spokes.reverse();
    // Edges that the way comes or goes along are not crossed.
    if matches!(to, Direction::Spoke(_)) {
        spokes.pop();
    }
    if matches!(from, Direction::Spoke(_)) && !spokes.is_empty() {
        spokes.remove(0);
    }
    if faces.is_empty() {
        // There and back along one edge.
        faces.push(topology.edge_corners(best.1?).first()?.face());
    }
    Some((faces, spokes))
}

fn angle(mesh: &IntrinsicMesh, corner: CornerId) -> f64 {
    let flat = Flat::new(mesh, corner.face(), corner.slot());
    let [x, y] = flat.last();
    y.atan2(x)
}
