//! Welds: two distant points of a surface become one.

use std::collections::HashSet;

use mesh::TriMesh;
use nalgebra::Point3;
use surface::{EdgeGraph, OneRing, Topology, VertexId};

use super::cut_off::farthest;
use crate::stream::Stream;

/// How two points are drawn that become one. They are far apart on the surface: at least half as far as the farthest point
/// is from the first. They meet in their middle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum WeldPair {
    /// Near in space, as a hand and the hip that it touches.
    Near,
    /// At random.
    Random,
}

/// Least distance of the two points on the surface, relative to the largest distance from the first.
const FAR: f64 = 0.5;

/// Draws of the first of two points that are near in space; the pair that is closest for its distance on the surface is taken.
const DRAWS: usize = 12;

/// Radius of the bump by which two near points are pushed together, relative to the gap between them.
const BUMP: f64 = 2.0;

/// Two vertices with disjoint faces, far apart on the surface and not beside those of earlier welds; `None` if there are none.
fn pair(
    mesh: &TriMesh,
    edges: &EdgeGraph,
    draw: WeldPair,
    earlier: &HashSet<VertexId>,
    stream: &mut Stream,
) -> Option<[VertexId; 2]> {
    let neighbors = |v: VertexId| edges.ways(v).iter().map(|way| way.to);
    let is_free = |v: &VertexId| {
        let mut near = neighbors(*v).peekable();
        near.peek().is_some() && !earlier.contains(v) && !near.any(|near| earlier.contains(&near))
    };
    let used: Vec<VertexId> = (0..mesh.n_vertices()).map(VertexId::from).filter(is_free).collect();
    if used.is_empty() {
        return None;
    }
    let space = |a: VertexId, b: VertexId| (mesh.positions[a.index()] - mesh.positions[b.index()]).norm();
    let mut best: Option<(f64, [VertexId; 2])> = None;
    for _ in 0..if draw == WeldPair::Near { DRAWS } else { 1 } {
        let first = used[stream.below(used.len())];
        let lengths = edges.from(first);
        let (_, reach) = farthest(&lengths);
        let beside = |v: VertexId| v == first || neighbors(first).any(|near| near == v);
        let far = |v: &VertexId| {
            let length = lengths[v.index()];
            let is_far = length.is_finite() && length >= FAR * reach && length > 0.0;
            is_far && !beside(*v) && !neighbors(*v).any(beside)
        };
        let others: Vec<VertexId> = used.iter().copied().filter(far).collect();
        if others.is_empty() {
            continue;
        }
        let second = match draw {
            WeldPair::Random => others[stream.below(others.len())],
            WeldPair::Near => {
                let by_gap = |a: &VertexId, b: &VertexId| space(first, *a).total_cmp(&space(first, *b));
                others.into_iter().min_by(by_gap)?
            }
        };
        let ratio = space(first, second) / lengths[second.index()];
        if best.is_none_or(|(known, _)| ratio < known) {
            best = Some((ratio, [first, second]));
        }
    }
    best.map(|(_, pair)| pair)
}

/// Pushes the surroundings of two near points together, until the points are at their middle.
fn push(mesh: &mut TriMesh, edges: &EdgeGraph, ends: [VertexId; 2]) {
    let [a, b] = ends.map(|end| mesh.positions[end.index()]);
    let middle = nalgebra::center(&a, &b);
    let radius = BUMP * (a - b).norm();
    for (end, old) in ends.into_iter().zip([a, b]) {
        let shift = middle - old;
        for (p, length) in mesh.positions.iter_mut().zip(edges.from(end)) {
            let share = (1.0 - length / radius.max(f64::MIN_POSITIVE)).max(0.0);
            *p += shift * (share * share * (3.0 - 2.0 * share));
        }
        mesh.positions[end.index()] = middle;
    }
}

/// Merges `n` pairs of vertices, which leaves spikes where they were not near in space.
pub(super) fn weld(mesh: &TriMesh, draw: WeldPair, n: u32, stream: &mut Stream) -> TriMesh {
    let mut welded = mesh.clone();
    let mut earlier = HashSet::new();
    for _ in 0..n {
        let edges = welded.edge_graph();
        let Some([a, b]) = pair(&welded, &edges, draw, &earlier, stream) else { break };
        let [p, q] = [a, b].map(|v| welded.positions[v.index()]);
        welded.positions[a.index()] = nalgebra::center(&p, &q);
        earlier.insert(a);
        welded.faces.iter_mut().flatten().filter(|v| **v == b).for_each(|v| *v = a);
    }
    welded.without_unused_vertices()
}

/// Joins `n` pairs of near points by handles: pushes them together, removes the faces around them, and connects the two
/// boundaries.
pub(super) fn contact(mesh: &TriMesh, n: u32, stream: &mut Stream) -> TriMesh {
    let mut joined = mesh.clone();
    let mut earlier = HashSet::new();
    for _ in 0..n {
        let edges = joined.edge_graph();
        let Some(ends) = pair(&joined, &edges, WeldPair::Near, &earlier, stream) else { break };
        let topology = joined.topology();
        let [Some(a), Some(b)] = ends.map(|v| rim(&topology, v)) else { continue };
        push(&mut joined, &edges, ends);
        joined.faces.retain(|face| !face.iter().any(|v| ends.contains(v)));
        earlier.extend(a.iter().chain(&b));
        let strip = strip(&a, &b, &joined.positions);
        joined.faces.extend(strip);
    }
    joined.without_unused_vertices()
}

/// The neighbors of an inner vertex in the order of its faces; `None` at a boundary, or where faces are turned over.
fn rim(topology: &Topology, v: VertexId) -> Option<Vec<VertexId>> {
    let mut ring = OneRing::default();
    ring.collect(topology, v);
    let mut fans = ring.fans();
    let fan = fans.next().filter(|fan| fan.is_closed)?;
    let follows = fan.corners.iter().all(|c| c.winding == surface::Winding::Forward);
    (fans.next().is_none() && follows)
        .then(|| fan.corners.iter().map(|c| topology.corner_vertex(c.corner.next())).collect())
}

/// Faces between two boundaries, which run around removed faces, each in the direction of these.
fn strip(a: &[VertexId], b: &[VertexId], positions: &[Point3<f64>]) -> Vec<[VertexId; 3]> {
    let gap = |v: VertexId| (positions[v.index()] - positions[a[0].index()]).norm();
    let nearest = (0..b.len()).min_by(|i, j| gap(b[*i]).total_cmp(&gap(b[*j]))).unwrap_or(0);
    let on_a = |i: usize| a[i % a.len()];
    let on_b = |j: usize| b[(nearest + b.len() - j % b.len()) % b.len()];
    let (mut i, mut j) = (0, 0);
    let mut faces = Vec::with_capacity(a.len() + b.len());
    while i < a.len() || j < b.len() {
        if j == b.len() || (i < a.len() && (i + 1) * b.len() <= (j + 1) * a.len()) {
            faces.push([on_a(i), on_a(i + 1), on_b(j)]);
            i += 1;
        } else {
            faces.push([on_b(j + 1), on_b(j), on_a(i)]);
            j += 1;
        }
    }
    faces
}
