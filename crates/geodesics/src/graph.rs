//! The edges of a surface as a graph.

use surface::{IntrinsicMesh, Rows};

/// Neighbours of every vertex along edges and links.
#[derive(Debug, Clone)]
pub(crate) struct EdgeGraph(Rows<(u32, f64)>);

impl EdgeGraph {
    /// The edges and links of `mesh`, in both directions.
    pub(crate) fn new(mesh: &IntrinsicMesh) -> Self {
        let edges = mesh.topology().edges().iter().zip(mesh.edge_lengths()).map(|(ends, l)| (*ends, *l));
        let links = mesh.links().iter().map(|link| (link.ends, link.length));
        let both = edges
            .chain(links)
            .flat_map(|([a, b], length)| [(a.index(), (b.0, length)), (b.index(), (a.0, length))]);
        Self(Rows::collect(mesh.n_vertices(), both))
    }

    pub(crate) fn n_vertices(&self) -> usize {
        self.0.n_rows()
    }

    #[inline]
    pub(crate) fn neighbours(&self, vertex: u32) -> &[(u32, f64)] {
        self.0.row(vertex as usize)
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
