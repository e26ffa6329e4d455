//! Neighbours on the surface become neighbours in memory.

use mesh::{CornerId, IntrinsicMesh, Link, Topology, VertexId};

/// A surface renumbered breadth first, and what became of the vertices and faces.
pub(super) struct Renumbered {
    pub(super) mesh: IntrinsicMesh,
    /// New number of every vertex.
    pub(super) vertices: Vec<u32>,
    /// New number of every face. The order of a face's corners stays.
    pub(super) faces: Vec<u32>,
}

/// Numbers vertices breadth first, one component after the other, and faces by their lowest vertex.
pub(super) fn renumbered(mesh: &IntrinsicMesh) -> Renumbered {
    let topology = mesh.topology();
    let vertices = breadth_first(topology);
    let new = |face: &[VertexId; 3]| face.map(|v| VertexId(vertices[v.index()]));
    let mut by_lowest: Vec<(VertexId, u32)> = (0u32..)
        .zip(topology.faces())
        .map(|(f, face)| {
            let [a, b, c] = new(face);
            (a.min(b).min(c), f)
        })
        .collect();
    by_lowest.sort_unstable();

    let mut faces = vec![0; topology.n_faces()];
    for (now, (_, before)) in (0u32..).zip(&by_lowest) {
        faces[*before as usize] = now;
    }
    let renumbered = Topology::new(
        topology.n_vertices(),
        by_lowest.iter().map(|(_, f)| new(&topology.faces()[*f as usize])).collect(),
    );
    let mut lengths = vec![0.0; renumbered.n_edges()];
    for (now, (_, before)) in (0u32..).zip(&by_lowest) {
        for slot in 0..3 {
            let old = topology.opposite_edge(CornerId(3 * before + slot));
            lengths[renumbered.opposite_edge(CornerId(3 * now + slot)).index()] = mesh.length(old);
        }
    }
    let link = |link: &Link| Link { ends: link.ends.map(|v| VertexId(vertices[v.index()])), ..*link };
    let links = mesh.links().iter().map(link).collect();
    Renumbered { mesh: IntrinsicMesh::new(renumbered, lengths).with_links(links), vertices, faces }
}

/// The position of every vertex in breadth-first order.
fn breadth_first(topology: &Topology) -> Vec<u32> {
    const UNSEEN: u32 = u32::MAX;
    let mut position = vec![UNSEEN; topology.n_vertices()];
    let mut order = Vec::with_capacity(topology.n_vertices());
    for root in (0..topology.n_vertices()).map(VertexId::from) {
        if position[root.index()] != UNSEEN {
            continue;
        }
        let mut head = order.len();
        position[root.index()] = head as u32;
        order.push(root);
        while let Some(&vertex) = order.get(head) {
            head += 1;
            for corner in topology.vertex_corners(vertex) {
                for neighbour in topology.faces()[corner.face().index()] {
                    if position[neighbour.index()] == UNSEEN {
                        position[neighbour.index()] = order.len() as u32;
                        order.push(neighbour);
                    }
                }
            }
        }
    }
    position
}
