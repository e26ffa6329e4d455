//! Non-manifold vertices and boundary loops, from the fans of faces around the vertices.

use surface::{DisjointSets, EdgeId, OneRing, Topology, VertexId};

use super::MeshReport;

impl MeshReport {
    /// Adds the counts of non-manifold vertices and boundary loops; linear time for bounded valence.
    pub(super) fn add_fans(&mut self, topology: &Topology) {
        let is_boundary = |edge: EdgeId| topology.edge_corners(edge).len() == 1;
        // Two boundary edges follow each other if they are the two ends of one fan.
        let mut boundary = DisjointSets::new(topology.n_edges());
        let mut ring = OneRing::default();
        // The edges at the ends of open fans, and the numbers of these fans.
        let mut ends: Vec<(EdgeId, u32)> = Vec::new();
        for vertex in (0..topology.n_vertices()).map(VertexId::from) {
            ring.collect(topology, topology.vertex_corners(vertex));
            ends.clear();
            for (i, fan) in (0..).zip(ring.fans()).filter(|(_, fan)| !fan.is_closed) {
                let edges = fan.ends().map(|corner| topology.opposite_edge(corner));
                if edges.into_iter().all(is_boundary) {
                    boundary.union(edges[0].0, edges[1].0);
                }
                ends.extend(edges.map(|edge| (edge, i)));
            }
            // Fans are connected through edges of more than two faces.
            ends.sort_unstable();
            let mut n_connected = ring.fans().count();
            let mut fans = DisjointSets::new(n_connected);
            for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                n_connected -= usize::from(fans.union(pair[0].1, pair[1].1));
            }
            self.non_manifold_vertices += usize::from(n_connected > 1);
        }
        self.n_boundary_loops = (0..topology.n_edges())
            .map(EdgeId::from)
            .filter(|edge| is_boundary(*edge) && boundary.find(edge.0) == edge.0)
            .count();
    }
}
