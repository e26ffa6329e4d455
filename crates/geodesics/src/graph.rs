//! The edges of a surface as a graph.

use mesh::{IntrinsicMesh, VertexId};

/// Neighbours of every vertex along edges and links, stored back to back.
#[derive(Debug, Clone)]
pub(crate) struct EdgeGraph {
    offsets: Vec<u32>,
    neighbours: Vec<(u32, f64)>,
}

impl EdgeGraph {
    /// The edges and links of `mesh`, in both directions.
    pub(crate) fn new(mesh: &IntrinsicMesh) -> Self {
        let edges = mesh.topology().edges().iter().zip(mesh.edge_lengths()).map(|(ends, l)| (*ends, *l));
        let links = mesh.links().iter().map(|link| (link.ends, link.length));
        Self::from_edges(mesh.n_vertices(), edges.chain(links))
    }

    fn from_edges(n: usize, edges: impl Iterator<Item = ([VertexId; 2], f64)> + Clone) -> Self {
        let mut offsets = vec![0u32; n + 1];
        for (ends, _) in edges.clone() {
            for end in ends {
                offsets[end.index() + 1] += 1;
            }
        }
        for v in 0..n {
            offsets[v + 1] += offsets[v];
        }
        let mut next = offsets.clone();
        let mut neighbours = vec![(0, 0.0); offsets[n] as usize];
        for ([a, b], length) in edges {
            for (from, to) in [(a, b), (b, a)] {
                let slot = &mut next[from.index()];
                neighbours[*slot as usize] = (to.0, length);
                *slot += 1;
            }
        }
        Self { offsets, neighbours }
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.offsets.len() - 1
    }

    #[inline]
    pub(crate) fn neighbours(&self, vertex: u32) -> &[(u32, f64)] {
        let v = vertex as usize;
        &self.neighbours[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }

    /// Vertices in breadth-first order, one component after the other: neighbours on the surface
    /// become neighbours in memory.
    pub(crate) fn breadth_first_order(&self) -> Vec<u32> {
        let n = self.n_vertices();
        let mut seen = vec![false; n];
        let mut order = Vec::with_capacity(n);
        for root in 0..n as u32 {
            if std::mem::replace(&mut seen[root as usize], true) {
                continue;
            }
            let mut head = order.len();
            order.push(root);
            while head < order.len() {
                let v = order[head];
                head += 1;
                for &(u, _) in self.neighbours(v) {
                    if !std::mem::replace(&mut seen[u as usize], true) {
                        order.push(u);
                    }
                }
            }
        }
        order
    }
}
