//! The graph of edges and links.

use surface::{IntrinsicMesh, Link, Rows, VertexId};

/// The neighbours of every vertex along edges and links, and their distances.
#[derive(Debug, Clone)]
pub(crate) struct EdgeGraph(Rows<(u32, f64)>);

impl EdgeGraph {
    pub(crate) fn new(mesh: &IntrinsicMesh) -> Self {
        let edges = mesh.topology().edges().iter().zip(mesh.edge_lengths());
        let edges = edges.map(|(ends, length)| Link { ends: *ends, length: *length });
        Self(Link::by_vertex(mesh.n_vertices(), edges.chain(mesh.links().iter().copied())))
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.0.n_rows()
    }

    #[inline]
    pub(crate) fn neighbours(&self, vertex: u32) -> &[(u32, f64)] {
        self.0.row(vertex as usize)
    }
}

/// Vertices in breadth-first order, one component after the other, so that neighbours are close in memory.
pub(crate) fn breadth_first_order<I: Iterator<Item = u32>>(
    n: usize,
    neighbours: impl Fn(u32) -> I,
) -> Vec<u32> {
    let mut is_visited = vec![false; n];
    // One more, for a neighbour that has been visited.
    let (mut order, mut end) = (vec![0; n + 1], 0);
    for root in 0..n as u32 {
        if std::mem::replace(&mut is_visited[root as usize], true) {
            continue;
        }
        let mut head = end;
        order[end] = root;
        end += 1;
        while head < end {
            for u in neighbours(order[head]) {
                // Without a branch, which could not be predicted.
                order[end] = u;
                end += usize::from(!std::mem::replace(&mut is_visited[u as usize], true));
            }
            head += 1;
        }
    }
    order.truncate(n);
    order
}

/// The same along the edges and links of a mesh: from each vertex first along edges, to lower vertices first.
pub(crate) fn breadth_first_order_of(mesh: &IntrinsicMesh) -> Vec<u32> {
    let (n, topology) = (mesh.n_vertices(), mesh.topology());
    let below = Rows::collect(n, topology.edges().iter().map(|[a, b]| (b.index(), a.0)));
    let links = Link::by_vertex(n, mesh.links().iter().copied());
    breadth_first_order(n, |v| {
        let above = topology.edges_above(VertexId(v)).iter().map(|[_, b]| b.0);
        let along_links = links.row(v as usize).iter().map(|(end, _)| *end);
        below.row(v as usize).iter().copied().chain(above).chain(along_links)
    })
}
