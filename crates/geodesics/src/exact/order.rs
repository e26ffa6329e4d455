//! Neighbours on the surface become neighbours in memory.

use surface::{FaceId, IntrinsicMesh, Link, Topology, VertexId};

/// A surface renumbered breadth first, and what became of the vertices and faces.
pub(super) struct Renumbered {
    pub(super) mesh: IntrinsicMesh,
    /// New number of every vertex.
    pub(super) vertices: Vec<u32>,
    /// New number of every face. The order of its corners stays, or is that of the face it repeats.
    pub(super) faces: Vec<u32>,
}

/// Numbers vertices breadth first, one component after the other, and faces by their vertices.
///
/// Of faces with the same vertices the first is kept: whatever path runs through another of them
/// can run through this one. Light would find a new way in every copy at every face.
pub(super) fn renumbered(mesh: &IntrinsicMesh) -> Renumbered {
    let topology = mesh.topology();
    let vertices = breadth_first(topology);
    let new = |face: &[VertexId; 3]| face.map(|v| VertexId(vertices[v.index()]));
    let mut sorted: Vec<([VertexId; 3], u32)> = (0u32..)
        .zip(topology.faces())
        .map(|(f, face)| {
            let mut key = new(face);
            key.sort_unstable();
            (key, f)
        })
        .collect();
    sorted.sort_unstable();

    let mut faces = vec![0; topology.n_faces()];
    let mut kept: Vec<u32> = Vec::with_capacity(sorted.len());
    for group in sorted.chunk_by(|p, q| p.0 == q.0) {
        for (_, f) in group {
            faces[*f as usize] = kept.len() as u32;
        }
        kept.push(group[0].1);
    }
    let renumbered = Topology::new(
        topology.n_vertices(),
        kept.iter().map(|f| new(&topology.faces()[*f as usize])).collect(),
    );
    let mut lengths = vec![0.0; renumbered.n_edges()];
    for (now, before) in (0u32..).zip(&kept) {
        for (old, new) in FaceId(*before).corners().into_iter().zip(FaceId(now).corners()) {
            lengths[renumbered.opposite_edge(new).index()] = mesh.opposite_length(old);
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
