//! Non-manifold vertices and boundary loops, from the fans of faces around the vertices.

use surface::{DisjointSets, OneRing, Topology, VertexId};

use super::MeshReport;

impl MeshReport {
    /// Adds the counts of non-manifold vertices and boundary loops; linear time for bounded valence.
    pub(super) fn add_fans(&mut self, topology: &Topology) {
        // Two boundary edges follow each other if they are the two ends of one fan.
        let mut boundary = DisjointSets::new(topology.n_edges());
        let mut ring = OneRing::default();
        for vertex in (0..topology.n_vertices()).map(VertexId::from) {
            ring.collect(topology, vertex);
            for fan in ring.fans().filter(|fan| !fan.is_closed) {
                let [first, last] = fan.ends().map(|corner| topology.opposite_edge(corner));
                if [first, last].iter().all(|edge| topology.edge_corners(*edge).len() == 1) {
                    boundary.union(first.0, last.0);
                }
            }
            let n_fans = ring.fans().count();
            if n_fans > 1 {
                let mut joined = ring.joined(topology, |_| false);
                let is_whole = (0..n_fans as u32).all(|fan| joined.find(fan) == 0);
                self.non_manifold_vertices += usize::from(!is_whole);
            }
        }
        let loops = topology.boundary_edges().filter(|edge| boundary.find(edge.0) == edge.0);
        self.n_boundary_loops = loops.count();
    }
}
