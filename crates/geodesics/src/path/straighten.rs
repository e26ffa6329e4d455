//! Making a path locally shortest.

use surface::IntrinsicMesh;

use super::funnel::shortest_through;
use super::strip::{PathSection, Portal, Strip, StripPath};
use super::turn::{Direction, inner_side};
use surface::SurfacePoint;

/// Share of its length that a detour must save; less is rounding.
const GAIN: f64 = 1e-13;

/// Limit of detours per node of the first path. Each makes the path shorter; real surfaces need fewer than two.
const DETOURS_PER_NODE: usize = 100;

/// Makes a path locally shortest: straight through the faces it crosses, bending only at vertices with at least 180
/// degrees on either side (Xin and Wang 2007, `xin2007`).
///
/// Replaces every section by the shortest path through its faces. Where the path then bends at a vertex with less
/// than 180 degrees on one side, leads it through the faces on that side and shortens it again. The path never gets
/// longer.
pub(super) fn straighten(mesh: &IntrinsicMesh, path: StripPath) -> StripPath {
    let mut path = tightened(mesh, path);
    let mut budget = DETOURS_PER_NODE * path.nodes.len();
    let mut at = 1;
    while at + 1 < path.nodes.len() && budget > 0 {
        if let Some((nodes, sections)) = detour(mesh, &path, at) {
            path.nodes.splice(at..=at, nodes);
            path.sections.splice(at - 1..=at, sections);
            budget -= 1;
            // The direction has changed at the node before as well.
            at = (at - 1).max(1);
        } else {
            at += 1;
        }
    }
    path
}

/// The path with every section replaced by the shortest through its faces.
fn tightened(mesh: &IntrinsicMesh, path: StripPath) -> StripPath {
    let ends: Vec<_> = path.nodes.iter().copied().zip(path.nodes.iter().copied().skip(1)).collect();
    let mut tight =
        StripPath { nodes: path.nodes[..1].to_vec(), sections: Vec::with_capacity(path.sections.len()) };
    for (section, (start, end)) in path.sections.into_iter().zip(ends) {
        match section {
            PathSection::Link(_) => tight.sections.push(section),
            PathSection::Strip(strip) => {
                let (nodes, sections) = shortest_through(mesh, strip, start, end);
                tight.nodes.extend(nodes);
                tight.sections.extend(sections);
            }
        }
        tight.nodes.push(end);
    }
    tight
}

/// A shorter path past the node `at`: what replaces that node, and the sections on either side of it.
fn detour(
    mesh: &IntrinsicMesh,
    path: &StripPath,
    at: usize,
) -> Option<(Vec<SurfacePoint>, Vec<PathSection>)> {
    let [start, node, end] = [path.nodes[at - 1], path.nodes[at], path.nodes[at + 1]];
    let [before, after] = [&path.sections[at - 1], &path.sections[at]];
    let SurfacePoint::Vertex(vertex) = node else { return None };
    let (PathSection::Strip(first), PathSection::Strip(second)) = (before, after) else { return None };
    let from = Direction::of(mesh, vertex, *first.faces.last()?, first.portals.last(), start)?;
    let to = Direction::of(mesh, vertex, *second.faces.first()?, second.portals.first(), end)?;
    let (faces, edges) = inner_side(mesh, vertex, &from, &to)?;
    // Along an edge no face is crossed; otherwise the face is the first or the last on the inner side.
    let upto = |strip: &Strip, direction: &Direction| direction.face.map_or(0, |_| strip.portals.len());
    let (n, m) = (upto(first, &from), upto(second, &to));
    let mut strip = Strip { faces: first.faces[..n].to_vec(), portals: first.portals[..n].to_vec() };
    strip.faces.extend(faces);
    strip.portals.extend(edges.into_iter().map(|edge| Portal { edge, t: 0.5 }));
    strip.portals.extend_from_slice(&second.portals[second.portals.len() - m..]);
    strip.faces.extend_from_slice(&second.faces[second.faces.len() - m..]);

    let (nodes, sections) = shortest_through(mesh, strip, start, end);
    let found = StripPath { nodes: [&[start], &nodes[..], &[end]].concat(), sections };
    let known = before.length(mesh, start, node) + after.length(mesh, node, end);
    (found.length(mesh) < known * (1.0 - GAIN)).then_some((nodes, found.sections))
}
