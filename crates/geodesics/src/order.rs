//! Orders of vertices in which neighbors are close in memory.

use surface::{EdgeGraph, IntrinsicMesh, VertexId};

/// Number of vertices in a patch.
const PATCH: usize = 64;

/// Vertices in patches of neighbors, along edges and links, that grow breadth-first, one next to the other. A front,
/// whatever its source, passes few patches at a time, where it would pass all of the rings of a breadth-first order.
pub(crate) fn patches_of(mesh: &IntrinsicMesh) -> Vec<u32> {
    let (n, topology) = (mesh.n_vertices(), mesh.topology());
    let links = EdgeGraph::new(n, mesh.links().iter().copied());
    // Most neighbors come twice, which costs less than to list the edges at every vertex.
    let neighbors = |v: u32| {
        let corners = topology.vertex_corners(VertexId(v)).iter();
        let around = corners.flat_map(|corner| topology.edge_ends(*corner));
        around.chain(links.ways(VertexId(v)).iter().map(|way| way.to)).map(|u| u.0)
    };
    let mut is_visited = vec![false; n];
    let mut order = Vec::with_capacity(n);
    let (mut waiting, mut next, mut lowest) = (Vec::new(), 0, 0);
    loop {
        let root = match waiting.get(next) {
            Some(root) => *root,
            None if lowest < n as u32 => {
                lowest += 1;
                lowest - 1
            }
            None => return order,
        };
        next += usize::from(next < waiting.len());
        if std::mem::replace(&mut is_visited[root as usize], true) {
            continue;
        }
        let start = order.len();
        order.push(root);
        let mut head = start;
        while head < order.len() && order.len() < start + PATCH {
            for u in neighbors(order[head]) {
                if !std::mem::replace(&mut is_visited[u as usize], true) {
                    order.push(u);
                }
            }
            head += 1;
        }
        // All neighbors of those before are in the order.
        for v in &order[head..] {
            waiting.extend(neighbors(*v).filter(|u| !is_visited[*u as usize]));
        }
    }
}

/// The place of every vertex in an order of all of them.
pub(crate) fn ranks(order: &[u32]) -> Vec<u32> {
    let mut ranks = vec![0; order.len()];
    for (rank, v) in (0..).zip(order) {
        ranks[*v as usize] = rank;
    }
    ranks
}
