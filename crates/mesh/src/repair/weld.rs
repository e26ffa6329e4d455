//! Merging vertices in the same position.

use nalgebra::Point3;
use surface::{DisjointSets, EdgeId, Topology, VertexId};

use super::options::Weld;
use crate::coincidence::coincident_pairs;

/// Merges vertices in the same position according to `policy`; returns how many were merged into another. No
/// face is degenerate.
pub(super) fn weld(
    positions: &[Point3<f64>],
    faces: &[[VertexId; 3]],
    policy: Weld,
    merged: &mut DisjointSets,
) -> usize {
    let pairs = match policy {
        Weld::None => return 0,
        Weld::Seams => coincident_pairs(positions, boundary_vertices(positions.len(), faces)),
        Weld::All => coincident_pairs(positions, 0..positions.len() as u32),
    };
    pairs.into_iter().filter(|&[a, b]| merged.union(a, b)).count()
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

/// Merges the ends of every edge of length zero; returns how many vertices were merged into another.
///
/// The faces at such an edge become degenerate and are removed. If its ends stayed apart, that would leave a slit.
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
