//! The orientation of faces.

use nalgebra::Point3;
use surface::{CornerId, FaceId, Topology};

use crate::face_set::is_degenerate;
use crate::tri_mesh::TriMesh;

/// The faces of a mesh grouped into patches, which manifold edges hold together, and the orientation of each patch.
#[derive(Debug, Clone)]
pub(crate) struct Orientation {
    /// The patch of every face.
    pub(crate) patch: Vec<u32>,
    /// Per face: whether to flip it, so that the patch is oriented consistently with the fewest flips.
    pub(crate) turned: Vec<bool>,
    /// Per patch: whether it is orientable (a Moebius strip is not).
    pub(crate) orientable: Vec<bool>,
    /// Per patch: whether every edge of every face joins exactly two faces.
    pub(crate) closed: Vec<bool>,
}

/// Whether two faces traverse the edge opposite a corner of each in the same direction, that is, are oriented
/// inconsistently.
pub(crate) fn has_same_direction(topology: &Topology, corner: CornerId, twin: CornerId) -> bool {
    topology.edge_ends(corner) == topology.edge_ends(twin)
}

impl Orientation {
    /// Propagates the orientation of the first face of every patch, in linear time.
    pub(crate) fn of(topology: &Topology) -> Self {
        const UNSEEN: u32 = u32::MAX;
        let n_faces = topology.n_faces();
        let mut patch = vec![UNSEEN; n_faces];
        let mut turned = vec![false; n_faces];
        let (mut orientable, mut closed) = (Vec::new(), Vec::new());
        let mut members = Vec::new();
        for seed in 0..n_faces {
            if patch[seed] != UNSEEN {
                continue;
            }
            let number = orientable.len() as u32;
            let (mut is_orientable, mut is_closed) = (true, true);
            patch[seed] = number;
            members.clear();
            members.push(seed);
            let mut at = 0;
            while let Some(&face) = members.get(at) {
                at += 1;
                let corners = FaceId::from(face).corners();
                let mut across = corners.map(|corner| topology.opposite(corner).map(|twin| (twin, corner)));
                // An order that does not depend on the orientation of faces, so that a second run changes
                // nothing, even on a patch that is not orientable.
                across.sort_unstable_by_key(|pair| {
                    pair.map(|(twin, corner)| (twin.face(), topology.opposite_edge(corner)))
                });
                for pair in across {
                    let Some((twin, corner)) = pair else {
                        is_closed = false;
                        continue;
                    };
                    let neighbor = twin.face().index();
                    let turn = turned[face] ^ has_same_direction(topology, corner, twin);
                    if patch[neighbor] == UNSEEN {
                        patch[neighbor] = number;
                        turned[neighbor] = turn;
                        members.push(neighbor);
                    } else if turned[neighbor] != turn {
                        is_orientable = false;
                    }
                }
            }
            if 2 * members.iter().filter(|&&f| turned[f]).count() > members.len() {
                members.iter().for_each(|&f| turned[f] = !turned[f]);
            }
            orientable.push(is_orientable);
            closed.push(is_closed);
        }
        Self { patch, turned, orientable, closed }
    }
}

/// Flips faces so that neighbors are oriented consistently; returns how many were flipped.
///
/// A patch is a set of faces joined by edges with exactly two faces. A closed patch ends up facing outward
/// (positive signed volume); any other keeps the orientation of the majority of its faces. A patch that is
/// not orientable, such as a Moebius strip, is made consistent along a spanning tree of its faces. Degenerate
/// faces are left alone. Linear time.
pub fn orient_consistently(mesh: &mut TriMesh) -> usize {
    let proper: Vec<usize> = (0..mesh.n_faces()).filter(|&f| !is_degenerate(mesh.faces[f])).collect();
    let faces = proper.iter().map(|&f| mesh.faces[f]).collect();
    let turned = turned_faces(&mesh.positions, &Topology::new(mesh.n_vertices(), faces));
    let to_turn: Vec<usize> =
        proper.into_iter().zip(turned).filter_map(|(f, turn)| turn.then_some(f)).collect();
    to_turn.iter().for_each(|&f| mesh.faces[f].swap(1, 2));
    to_turn.len()
}

/// Which faces [`orient_consistently`] flips.
pub(crate) fn turned_faces(positions: &[Point3<f64>], topology: &Topology) -> Vec<bool> {
    let Orientation { patch, mut turned, orientable, closed } = Orientation::of(topology);
    // Six times the signed volume of every patch, relative to its first vertex to keep the terms small.
    let mut volume = vec![0.0; closed.len()];
    let mut origin = vec![None; closed.len()];
    for ((face, turned), patch) in topology.faces().iter().zip(&turned).zip(&patch) {
        let [a, b, c] = face.map(|v| positions[v.index()]);
        let from = *origin[*patch as usize].get_or_insert(a);
        let term = (a - from).dot(&(b - from).cross(&(c - from)));
        volume[*patch as usize] += if *turned { -term } else { term };
    }
    let inside_out = |p: usize| closed[p] && orientable[p] && volume[p] < 0.0;
    for (turn, &p) in turned.iter_mut().zip(&patch) {
        *turn ^= inside_out(p as usize);
    }
    turned
}
