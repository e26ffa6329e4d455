//! Renumbering: neighbours on the surface become neighbours in memory.

use surface::{FaceId, IntrinsicMesh, Link, Topology, VertexId};

use crate::graph::breadth_first_order;

pub(super) struct Renumbered {
    pub(super) mesh: IntrinsicMesh,
    /// The new number of every vertex.
    pub(super) vertices: Vec<u32>,
    /// The new number of every face. The order of its corners stays, or is that of the face it repeats.
    pub(super) faces: Vec<u32>,
}

/// Numbers vertices breadth first, one component after the other, and faces by their vertices.
///
/// Of faces with the same vertices, only the first is kept: any path through another can run through it, and windows
/// would multiply at every face.
pub(super) fn renumbered(mesh: &IntrinsicMesh) -> Renumbered {
    let topology = mesh.topology();
    let around = |v: u32| topology.vertex_corners(VertexId(v)).iter().map(|corner| corner.face().index());
    let neighbours = |v: u32| around(v).flat_map(|face| topology.faces()[face]).map(|neighbour| neighbour.0);
    let mut vertices = vec![0; topology.n_vertices()];
    for (new, old) in (0..).zip(breadth_first_order(topology.n_vertices(), neighbours)) {
        vertices[old as usize] = new;
    }
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
