//! Obtuse corners replaced by two acute ones.

use surface::{CornerId, IntrinsicMesh, VertexId};

use super::chains::{Arm, Part, Reaches};
use super::unfold::{Split, Unfolding, unfold};

/// Lengths that differ by less than this share are one length but for rounding.
const SAME_LENGTH: f64 = 1e-12;

/// The halves of all obtuse corners that unfolding can split, as parts of their vertices, and how
/// many obtuse corners it cannot.
pub(super) fn splits(mesh: &IntrinsicMesh) -> (Vec<(u32, Part)>, usize) {
    let mut parts = Vec::new();
    let mut not_split = 0;
    for corner in (0..3 * mesh.topology().n_faces() as u32).map(CornerId) {
        match unfold(mesh, corner) {
            Unfolding::Split(split) => add_halves(mesh, corner, &split, &mut parts),
            Unfolding::Stopped => not_split += 1,
            Unfolding::Acute => {}
        }
    }
    (parts, not_split)
}

fn add_halves(mesh: &IntrinsicMesh, corner: CornerId, split: &Split, parts: &mut Vec<(u32, Part)>) {
    let topology = mesh.topology();
    let (apex, middle) = (topology.corner_vertex(corner).0, split.vertex.0);
    let [_, from_a, from_b] = mesh.sides(corner);
    for ((end, base), from_end) in
        topology.edge_ends(corner).into_iter().zip(split.bases).zip([from_a, from_b])
    {
        // Where the base of the half is an edge, it belongs to other triangles of its ends, too.
        let edge = topology.edge_between(end, split.vertex).map(|edge| mesh.length(edge));
        let edge = edge.filter(|length| (length - base).abs() <= SAME_LENGTH * base);
        let arm = |to: VertexId| edge.map_or(Arm::side(to.0, base), |length| Arm::edge(to.0, length));
        let at_end = [Arm::edge(apex, from_end), arm(split.vertex)];
        let at_middle = [Arm::edge(apex, split.length), arm(end)];
        parts.push((end.0, Part::triangle(at_end, split.length, Reaches::First)));
        parts.push((middle, Part::triangle(at_middle, from_end, Reaches::First)));
    }
    // The segment inside the strip is a way back, too.
    parts.push((apex, Part::Bare(Arm::edge(middle, split.length))));
}
