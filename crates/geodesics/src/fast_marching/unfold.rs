//! Obtuse corners split by unfolding the surface behind them (Kimmel and Sethian 1998, `kimmel1998`).
//!
//! A front may reach an obtuse corner `C` before both ends of the base `AB` are finalized. The triangles behind the
//! base are laid out in the plane of `ABC` until a vertex `D` lies in the cone of directions that make acute angles
//! with both `CA` and `CB`. The segment `CD` is inside the unfolded strip and splits the corner in two.

use surface::{CornerId, FaceId, IntrinsicMesh, Link, VertexId};

use crate::plane::{GateSide, apex, beyond, dot, norm, sub};

/// Limit of the triangles in a strip; strips of slivers may have no end.
const MAX_STEPS: usize = 12;

/// Half of an obtuse corner that unfolding has split, at one end of its base: a triangle that is used in one
/// direction only, from the base to the apex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfCorner {
    /// The other end of the base, and its distance.
    pub(super) base: (VertexId, f64),
    /// The vertex in the obtuse corner, and its distance.
    pub(super) apex: (VertexId, f64),
    /// The length of the third side.
    pub(super) third: f64,
}

/// Splits all obtuse corners of a mesh where unfolding finds a vertex. Returns the segments that split them, and
/// their halves with the vertices at both ends of each base.
pub(super) fn split_obtuse_corners(mesh: &IntrinsicMesh) -> (Vec<Link>, Vec<(VertexId, HalfCorner)>) {
    let (topology, mut segments, mut halves) = (mesh.topology(), Vec::new(), Vec::new());
    for corner in (0..topology.n_faces()).flat_map(|f| FaceId::from(f).corners()) {
        let Some((middle, length, bases)) = split(mesh, corner) else { continue };
        let apex = topology.corner_vertex(corner);
        let [_, from_a, from_b] = mesh.sides(corner);
        for ((end, base), side) in topology.edge_ends(corner).into_iter().zip(bases).zip([from_a, from_b]) {
            let at_end = HalfCorner { base: (middle, base), apex: (apex, side), third: length };
            let at_middle = HalfCorner { base: (end, base), apex: (apex, length), third: side };
            halves.extend([(end, at_end), (middle, at_middle)]);
        }
        segments.push(Link { ends: [apex, middle], length });
    }
    (segments, halves)
}

/// Unfolds the surface behind a corner: the vertex `D`, `|CD|`, and `|AD|` and `|BD|`. Returns `None` if the corner is not obtuse, or if the strip reaches the
/// boundary or a non-manifold edge, or gets too long.
fn split(mesh: &IntrinsicMesh, corner: CornerId) -> Option<(VertexId, f64, [f64; 2])> {
    let [c, b, a] = mesh.sides(corner);
    if a * a + b * b >= c * c {
        return None;
    }
    let apex = apex([c, b, a]);
    let (at_a, at_b) = ([0.0, 0.0], [c, 0.0]);
    let (to_a, to_b) = (sub(at_a, apex), sub(at_b, apex));
    let topology = mesh.topology();

    // The last edge of the strip, from the side of A to the side of B, and the corner opposite it.
    let mut facing = corner;
    let [mut left, mut right] = topology.edge_ends(corner);
    let (mut at_left, mut at_right) = (at_a, at_b);
    for _ in 0..MAX_STEPS {
        let next = topology.opposite(facing)?;
        let vertex = topology.corner_vertex(next);
        let [edge, mut from_left, mut from_right] = mesh.sides(next);
        let (mut opposite_left, mut opposite_right) = (next.next(), next.prev());
        if topology.corner_vertex(opposite_left) != left {
            std::mem::swap(&mut from_left, &mut from_right);
            std::mem::swap(&mut opposite_left, &mut opposite_right);
        }
        if edge <= 0.0 {
            return None;
        }
        // The new vertex is on the other side of the edge than the apex.
        let at = beyond([at_left, at_right], [edge, from_left, from_right], GateSide::Behind);
        let ray = sub(at, apex);
        match (dot(ray, to_a) > 0.0, dot(ray, to_b) > 0.0) {
            (true, true) => {
                let bases = [at_a, at_b].map(|end| norm(sub(at, end)));
                return Some((vertex, norm(ray), bases));
            }
            // Too far on the side of A: the cone leaves through the edge from the new vertex to the right end.
            (true, false) => (left, at_left, facing) = (vertex, at, opposite_left),
            _ => (right, at_right, facing) = (vertex, at, opposite_right),
        }
        if left == right {
            return None;
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::spatial;

    #[test]
    fn unfolding_stops_at_the_boundary_and_at_non_manifold_edges() {
        let points =
            [[0.0, 0.4], [-2.0, 0.0], [2.0, 0.0], [0.3, -1.0], [0.2, -3.0]].map(|[x, y]| [x, y, 0.0]);
        assert_eq!(split(&spatial(&points, &[[0, 1, 2]]), CornerId(0)), None);
        let fan = spatial(&points, &[[0, 1, 2], [2, 1, 3], [1, 2, 4]]);
        assert_eq!(split(&fan, CornerId(0)), None);
    }
}
