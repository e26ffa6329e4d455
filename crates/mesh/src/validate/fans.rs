//! How the faces around each vertex hang together.

use surface::DisjointSets;
use surface::{CornerId, EdgeId, Topology, VertexId};

/// What the fans of faces around the vertices tell of a mesh.
pub(super) struct Fans {
    /// Vertices whose faces form more than one fan.
    pub(super) non_manifold_vertices: usize,
    /// Chains of boundary edges.
    pub(super) boundary_loops: usize,
}

impl Fans {
    /// Walks around every vertex; linear time for bounded valence.
    pub(super) fn of(topology: &Topology) -> Self {
        let mut non_manifold_vertices = 0;
        // Two boundary edges follow each other when they end the same fan of faces around a vertex.
        let mut boundary = DisjointSets::new(topology.n_edges());
        let mut spokes: Vec<(EdgeId, u32)> = Vec::new();
        for vertex in (0..topology.n_vertices()).map(VertexId::from) {
            let corners = topology.vertex_corners(vertex);
            spokes.clear();
            for (i, &corner) in (0u32..).zip(corners) {
                spokes.extend(spokes_of(topology, corner).map(|edge| (edge, i)));
            }
            spokes.sort_unstable();
            let mut fans = DisjointSets::new(corners.len());
            let mut fan_count = corners.len();
            let mut sheets = DisjointSets::new(corners.len());
            for group in spokes.chunk_by(|a, b| a.0 == b.0) {
                for pair in group.windows(2) {
                    fan_count -= usize::from(fans.union(pair[0].1, pair[1].1));
                }
                if let [a, b] = group {
                    sheets.union(a.1, b.1);
                }
            }
            non_manifold_vertices += usize::from(fan_count > 1);
            // At most two boundary edges end the same sheet.
            let mut ends: Vec<(u32, EdgeId)> = spokes
                .chunk_by(|a, b| a.0 == b.0)
                .filter_map(|group| match group {
                    [(edge, i)] => Some((sheets.find(*i), *edge)),
                    _ => None,
                })
                .collect();
            ends.sort_unstable();
            for pair in ends.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
                boundary.union(pair[0].1.0, pair[1].1.0);
            }
        }
        let is_boundary = |edge: u32| topology.edge_corners(EdgeId(edge)).len() == 1;
        let boundary_loops =
            (0..boundary.len() as u32).filter(|&e| is_boundary(e) && boundary.find(e) == e).count();
        Self { non_manifold_vertices, boundary_loops }
    }
}

/// The two edges of a face that meet in one of its corners.
fn spokes_of(topology: &Topology, corner: CornerId) -> impl Iterator<Item = EdgeId> {
    let first = corner.face().0 * 3;
    let slot = corner.slot() as u32;
    [1, 2].map(|step| topology.opposite_edge(CornerId(first + (slot + step) % 3))).into_iter()
}
