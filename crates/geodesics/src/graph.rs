//! The graph of edges and links.

use surface::{IntrinsicMesh, Link, Rows};

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

    pub(crate) fn breadth_first_order(&self) -> Vec<u32> {
        breadth_first_order(self.n_vertices(), |v| self.neighbours(v).iter().map(|(u, _)| *u))
    }
}

/// Vertices in breadth-first order, one component after the other, so that neighbours are close in memory.
pub(crate) fn breadth_first_order<I: Iterator<Item = u32>>(
    n: usize,
    neighbours: impl Fn(u32) -> I,
) -> Vec<u32> {
    let mut is_visited = vec![false; n];
    let mut order = Vec::with_capacity(n);
    for root in 0..n as u32 {
        if std::mem::replace(&mut is_visited[root as usize], true) {
            continue;
        }
        let mut head = order.len();
        order.push(root);
        while let Some(&v) = order.get(head) {
            head += 1;
            for u in neighbours(v) {
                if !std::mem::replace(&mut is_visited[u as usize], true) {
                    order.push(u);
                }
            }
        }
    }
    order
}
