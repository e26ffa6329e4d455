//! The boundary of a surface.

use surface::{Components, IntrinsicMesh, Rows, Topology, VertexId};

/// The other ends of the boundary edges at every vertex.
pub(crate) fn neighbors(topology: &Topology) -> Rows<VertexId> {
    let edges: Vec<_> = topology.boundary_edges().map(|edge| topology.edges()[edge.index()]).collect();
    let both = edges.iter().flat_map(|&[a, b]| [(a.index(), b), (b.index(), a)]);
    Rows::collect(topology.n_vertices(), both)
}

/// The boundaries that touch neither themselves nor another one, by their lowest vertices. Each begins with it and goes on to
/// the lower one of its neighbors.
pub(crate) fn simple_boundaries(topology: &Topology) -> Vec<Vec<VertexId>> {
    let neighbors = neighbors(topology);
    let mut is_seen = vec![false; topology.n_vertices()];
    let mut found = Vec::new();
    for first in (0..topology.n_vertices()).map(VertexId::from) {
        let mut boundary: Vec<VertexId> = Vec::new();
        let mut at = first;
        let is_closed = loop {
            let [a, b] = *neighbors.row(at.index()) else { break false };
            if std::mem::replace(&mut is_seen[at.index()], true) {
                break at == first && !boundary.is_empty();
            }
            let before = boundary.last().copied();
            boundary.push(at);
            at = match before {
                None => a.min(b),
                Some(before) if a == before => b,
                Some(_) => a,
            };
        };
        if is_closed {
            found.push(boundary);
        }
    }
    found
}

/// The vertices of each boundary, and its length. Boundaries that touch count as one.
pub(crate) fn boundaries(mesh: &IntrinsicMesh) -> Vec<(Vec<VertexId>, f64)> {
    let topology = mesh.topology();
    let edges = || topology.boundary_edges().map(|edge| (edge, topology.edges()[edge.index()]));
    let joined = Components::joined(mesh.n_vertices(), edges().map(|(_, ends)| ends));
    let mut found = vec![(Vec::new(), 0.0); joined.count];
    for v in (0..mesh.n_vertices()).map(VertexId::from) {
        joined.of(v).into_iter().for_each(|boundary| found[boundary].0.push(v));
    }
    for (edge, [end, _]) in edges() {
        joined.of(end).into_iter().for_each(|boundary| found[boundary].1 += mesh.length(edge));
    }
    found
}
