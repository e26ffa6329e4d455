//! Making a way as short as it gets without lifting it over anything.

use surface::IntrinsicMesh;

use super::funnel::shortest_through;
use super::strip::{Portal, Section, Strip, Way};
use super::turn::{At, Direction, direction, inner_side};
use crate::SurfacePoint;

/// Share of its length that a detour must save to count.
const GAIN: f64 = 1e-13;

/// Detours that may be taken for every node of the first way, and at least; each makes the way
/// shorter, and real surfaces need fewer than two.
const DETOURS_PER_NODE: usize = 100;

/// Makes a way locally shortest: straight through the faces it crosses, and bending only at vertices
/// where either side is at least half a turn.
///
/// Every section becomes the shortest way through its own faces. Where the way then bends at a vertex
/// by less than half a turn on one side, it is led through the faces on that side instead, and
/// that part is made shortest again. The way never gets longer (Xin and Wang 2007, `xin2007`).
pub(super) fn straighten(mesh: &IntrinsicMesh, way: Way) -> Way {
    let mut way = tightened(mesh, way);
    let mut budget = DETOURS_PER_NODE * way.nodes.len();
    let mut at = 1;
    while at + 1 < way.nodes.len() && budget > 0 {
        if let Some((nodes, sections)) = detour(mesh, &way, at) {
            way.nodes.splice(at..=at, nodes);
            way.sections.splice(at - 1..=at, sections);
            budget -= 1;
            // The direction has changed at the node before as well.
            at = (at - 1).max(1);
        } else {
            at += 1;
        }
    }
    way
}

/// Every section made the shortest way through its faces.
fn tightened(mesh: &IntrinsicMesh, way: Way) -> Way {
    let ends: Vec<_> = way.nodes.iter().copied().zip(way.nodes.iter().copied().skip(1)).collect();
    let mut tight = Way { nodes: way.nodes[..1].to_vec(), sections: Vec::with_capacity(way.sections.len()) };
    for (section, (start, end)) in way.sections.into_iter().zip(ends) {
        match section {
            Section::Link(_) => tight.sections.push(section),
            Section::Strip(strip) => {
                let (nodes, sections) = shortest_through(mesh, strip, start, end);
                tight.nodes.extend(nodes);
                tight.sections.extend(sections);
            }
        }
        tight.nodes.push(end);
    }
    tight
}

/// What replaces the node `at` and the sections on either side of it by a shorter way past it.
fn detour(mesh: &IntrinsicMesh, way: &Way, at: usize) -> Option<(Vec<SurfacePoint>, Vec<Section>)> {
    let [start, node, end] = [way.nodes[at - 1], way.nodes[at], way.nodes[at + 1]];
    let [before, after] = [&way.sections[at - 1], &way.sections[at]];
    let SurfacePoint::Vertex(vertex) = node else { return None };
    let (Section::Strip(first), Section::Strip(second)) = (before, after) else { return None };
    let from = direction(mesh, vertex, first, At::End, start)?;
    let to = direction(mesh, vertex, second, At::Start, end)?;
    let (faces, spokes) = inner_side(mesh, vertex, from, to)?;
    // Along an edge no face is crossed; into a face, it is the first or the last of the fan.
    let upto = |strip: &Strip, direction| match direction {
        Direction::Spoke(_) => 0,
        Direction::Inside { .. } => strip.portals.len(),
    };
    let (n, m) = (upto(first, from), upto(second, to));
    let mut strip = Strip { faces: first.faces[..n].to_vec(), portals: first.portals[..n].to_vec() };
    strip.faces.extend(faces);
    strip.portals.extend(spokes.into_iter().map(|edge| Portal { edge, t: 0.5 }));
    strip.portals.extend_from_slice(&second.portals[second.portals.len() - m..]);
    strip.faces.extend_from_slice(&second.faces[second.faces.len() - m..]);

    let (nodes, sections) = shortest_through(mesh, strip, start, end);
    let found = Way { nodes: [&[start], &nodes[..], &[end]].concat(), sections };
    let known = before.length(mesh, start, node) + after.length(mesh, node, end);
    (found.length(mesh) < known * (1.0 - GAIN)).then_some((nodes, found.sections))
}
