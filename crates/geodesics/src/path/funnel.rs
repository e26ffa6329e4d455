//! The shortest path through a strip of faces.

use std::collections::VecDeque;

use surface::{IntrinsicMesh, VertexId};

use super::strip::{Gate, Laid, PathSection, Portal, Strip};
use crate::plane::{PlanePoint, cross, dot, sub};
use surface::SurfacePoint;

/// A path that crosses an edge within this share of its length from a vertex goes through the vertex: the difference is
/// rounding.
const SNAP: f64 = 1e-10;

/// A vertex on the side of a strip that the shortest path touches.
#[derive(Debug, Clone, Copy)]
struct Touch {
    vertex: VertexId,
    at: PlanePoint,
    /// The first and the last of the gates in a row that have it as an end.
    first: usize,
    last: usize,
}

/// The shortest path between two points through a strip: its inner nodes, and the sections between all nodes.
pub(super) fn shortest_through(
    mesh: &IntrinsicMesh,
    strip: Strip,
    start: SurfacePoint,
    end: SurfacePoint,
) -> (Vec<SurfacePoint>, Vec<PathSection>) {
    let strip = strip.simplified(mesh, start, end);
    let laid = strip.lay_out(mesh, start, end);
    let touches = touches(&laid);
    let nodes = touches.iter().map(|touch| SurfacePoint::Vertex(touch.vertex)).collect();
    let mut sections = Vec::with_capacity(touches.len() + 1);
    // The last touch and the gate after those that have it as an end.
    let (mut here, mut first, mut next) = (laid.start, 0, 0);
    for touch in touches.iter().map(Some).chain([None]) {
        let (to, until) = touch.map_or((laid.end, laid.gates.len()), |t| (t.at, t.first));
        sections.push(PathSection::Strip(if until < next {
            // Along an edge that is itself a gate.
            Strip::within(strip.faces[until.max(first)])
        } else {
            let cross = |(portal, gate): (&Portal, &Gate)| {
                let share = share(gate, here, to);
                let t = if gate[0].0 < gate[1].0 { share } else { 1.0 - share };
                Portal { t, ..*portal }
            };
            Strip {
                faces: strip.faces[next..=until].to_vec(),
                portals: strip.portals[next..until].iter().zip(&laid.gates[next..until]).map(cross).collect(),
            }
        }));
        if let Some(touch) = touch {
            (here, first, next) = (touch.at, touch.first, touch.last + 1);
        }
    }
    (nodes, sections)
}

/// Where a straight line crosses a gate, from 0 at its left end to 1 at its right.
fn share(gate: &Gate, from: PlanePoint, to: PlanePoint) -> f64 {
    let direction = sub(to, from);
    let left = cross(direction, sub(gate[0].1, from));
    let right = cross(direction, sub(gate[1].1, from));
    let share = left / (left - right);
    // A line along the gate, or none at all, may take either end.
    if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) }
}

/// All vertices that the shortest path touches, whether it bends there or not.
fn touches(laid: &Laid) -> Vec<Touch> {
    let mut all: Vec<Touch> = Vec::new();
    let (mut here, mut next) = (laid.start, 0);
    for bend in bends(laid).into_iter().map(Some).chain([None]) {
        let (to, until) = bend.map_or((laid.end, laid.gates.len()), |b| (b.at, b.first));
        while next < until {
            let share = share(&laid.gates[next], here, to);
            if (SNAP..=1.0 - SNAP).contains(&share) {
                next += 1;
            } else {
                let end = usize::from(share >= 0.5);
                let touch = touch(&laid.gates, next, end);
                (here, next) = (touch.at, touch.last + 1);
                all.push(touch);
            }
        }
        if let Some(bend) = bend {
            if all.last().is_none_or(|last| last.vertex != bend.vertex || last.last < bend.first) {
                all.push(bend);
            }
            (here, next) = (bend.at, next.max(bend.last + 1));
        }
    }
    all
}

/// An end of a gate, and of the gates before and after it that share it.
fn touch(gates: &[Gate], gate: usize, end: usize) -> Touch {
    let (vertex, at) = gates[gate][end];
    let is_same = |other: &&Gate| other[end].0 == vertex;
    Touch {
        vertex,
        at,
        first: gate - gates[..gate].iter().rev().take_while(is_same).count(),
        last: gate + gates[gate + 1..].iter().take_while(is_same).count(),
    }
}

/// A point that the funnel has reached, and the one before it on the shortest path.
#[derive(Debug, Clone, Copy)]
struct Reached {
    at: PlanePoint,
    before: usize,
    gate: usize,
    end: usize,
}

/// The vertices where the shortest path bends, in order (Lee and Preparata 1984, `lee1984`).
///
/// The shortest paths from the start to the two ends of a gate coincide up to the apex, then separate into two chains
/// that bend outwards: the funnel. The next gate has a new point on one side, which straightens the chain of that
/// side or, if no vertex of it is left, moves the apex along the other.
fn bends(laid: &Laid) -> Vec<Touch> {
    let mut reached = vec![Reached { at: laid.start, before: 0, gate: 0, end: 0 }];
    let mut apex = 0;
    let mut chains = [VecDeque::new(), VecDeque::new()];
    let mut extend = |at: PlanePoint, gate: usize, end: usize| {
        let [left, right] = &mut chains;
        // For the left side; on the right, left and right are exchanged.
        let (own, other, sign) = match end {
            0 => (left, right, 1.0),
            _ => (right, left, -1.0),
        };
        let turn = |a: PlanePoint, b: PlanePoint, c: PlanePoint| sign * cross(sub(b, a), sub(c, b));
        while let Some(&last) = own.back() {
            let before = own.len().checked_sub(2).map_or(apex, |i| own[i]);
            if turn(reached[before].at, reached[last].at, at) > 0.0 {
                break;
            }
            own.pop_back();
        }
        if own.is_empty() {
            while let Some(&first) = other.front() {
                let (from, corner) = (reached[apex].at, reached[first].at);
                let turn = turn(from, corner, at);
                // From a point of the gate itself, as in a face without area, its ends lie in opposite directions.
                if turn > 0.0 || (turn == 0.0 && dot(sub(corner, from), sub(at, corner)) < 0.0) {
                    break;
                }
                apex = first;
                other.pop_front();
            }
        }
        reached.push(Reached { at, before: own.back().copied().unwrap_or(apex), gate, end });
        own.push_back(reached.len() - 1);
    };
    for (i, gate) in laid.gates.iter().enumerate() {
        let is_new = |end: usize| i == 0 || laid.gates[i - 1][end].0 != gate[end].0;
        for end in [0, 1] {
            if is_new(end) {
                extend(gate[end].1, i, end);
            }
        }
    }
    extend(laid.end, laid.gates.len(), 0);
    let mut bends = Vec::new();
    let mut at = reached[reached.len() - 1].before;
    while at != 0 {
        bends.push(touch(&laid.gates, reached[at].gate, reached[at].end));
        at = reached[at].before;
    }
    bends.reverse();
    bends
}
