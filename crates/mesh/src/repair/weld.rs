//! Making one vertex of several in the same place.

use nalgebra::Point3;

use crate::position_key::position_key;
use surface::DisjointSets;
use surface::{EdgeId, Topology, VertexId};

use super::Weld;

/// Merges vertices in the same place as `policy` says; returns how many went into another.
///
/// No face names a vertex twice.
pub(super) fn weld(
    positions: &[Point3<f64>],
    faces: &[[VertexId; 3]],
    policy: Weld,
    merged: &mut DisjointSets,
) -> usize {
    let candidates = match policy {
        Weld::None => return 0,
        Weld::Seams => boundary_vertices(positions.len(), faces),
        Weld::All => (0..positions.len() as u32).collect(),
    };
    let mut placed: Vec<([u64; 3], u32)> =
        candidates.into_iter().map(|v| (position_key(&positions[v as usize]), v)).collect();
    placed.sort_unstable();
    let twins = placed.windows(2).filter(|pair| pair[0].0 == pair[1].0);
    twins.filter(|pair| merged.union(pair[0].1, pair[1].1)).count()
}

fn boundary_vertices(n_vertices: usize, faces: &[[VertexId; 3]]) -> Vec<u32> {
    let topology = Topology::new(n_vertices, faces.to_vec());
    let mut on_boundary = vec![false; n_vertices];
    for (e, ends) in topology.edges().iter().enumerate() {
        if topology.edge_corners(EdgeId::from(e)).len() == 1 {
            ends.iter().for_each(|v| on_boundary[v.index()] = true);
        }
    }
    (0..n_vertices as u32).filter(|&v| on_boundary[v as usize]).collect()
}

/// Merges the ends of every edge of length zero; returns how many vertices went into another.
///
/// The face on such an edge must go, and with its ends kept apart it would leave a slit.
pub(super) fn collapse_zero_edges(
    positions: &[Point3<f64>],
    faces: &[[VertexId; 3]],
    merged: &mut DisjointSets,
) -> usize {
    let mut count = 0;
    for &[a, b, c] in faces {
        for [u, v] in [[a, b], [b, c], [c, a]] {
            if positions[u.index()] == positions[v.index()] {
                count += usize::from(merged.union(u.0, v.0));
            }
        }
    }
    count
}
