//! Splitting of obtuse corners by unfolding the surface across their base.
//!
//! A front can reach an obtuse corner `C` before it has passed both ends of the base `AB`. Following
//! Kimmel and Sethian 1998, the triangles behind the base are laid out in the plane of `ABC` until a
//! vertex `D` falls into the cone of directions that make an acute angle with both `CA` and `CB`;
//! the segment `CD` then lies inside the unfolded strip and splits the corner into two acute ones.

use surface::{CornerId, IntrinsicMesh, VertexId};

use crate::corner::Corner;

/// More steps than any reasonable strip of triangles needs; a strip of slivers may go on for ever.
const MAX_STEPS: usize = 12;

/// How an obtuse corner was treated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unfolding {
    /// The corner is not obtuse.
    Acute,
    /// A vertex of the unfolded strip splits it.
    Split(Split),
    /// A boundary, a non-manifold edge or too long a strip: only the edges carry the front.
    Stopped,
}

/// The two acute corners at `C` that replace an obtuse one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Split {
    /// The vertex that splits the corner.
    pub(super) vertex: VertexId,
    /// Its straight distance to the corner's vertex inside the strip.
    pub(super) length: f64,
    /// Its straight distances to `A` and `B` in the plane of the strip.
    pub(super) bases: [f64; 2],
}

type Point = [f64; 2];

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn norm(a: Point) -> f64 {
    dot(a, a).sqrt()
}

/// Unfolds the surface behind `corner` if it is obtuse.
pub(super) fn unfold(mesh: &IntrinsicMesh, corner: CornerId) -> Unfolding {
    let [c, b, a] = mesh.sides(corner);
    if a * a + b * b >= c * c {
        return Unfolding::Acute;
    }
    let flat = Corner::from_lengths(c, b, a);
    let apex = [flat.x, flat.y];
    let (at_a, at_b) = ([0.0, 0.0], [c, 0.0]);
    let (to_a, to_b) = (sub(at_a, apex), sub(at_b, apex));
    let topology = mesh.topology();

    // The strip's last edge, from the side of A to the side of B, and the corner facing it.
    let mut facing = corner;
    let [mut left, mut right] = topology.edge_ends(corner);
    let (mut at_left, mut at_right) = (at_a, at_b);
    for _ in 0..MAX_STEPS {
        let Some(next) = topology.opposite(facing) else { return Unfolding::Stopped };
        let vertex = topology.corner_vertex(next);
        let [edge, from_first, from_second] = mesh.sides(next);
        let starts_left = topology.edge_ends(next)[0] == left;
        let (from_left, from_right) =
            if starts_left { (from_first, from_second) } else { (from_second, from_first) };
        let beyond = Corner::from_lengths(edge, from_left, from_right);
        if !beyond.y.is_finite() {
            return Unfolding::Stopped;
        }
        // The new vertex, on the other side of the edge than the apex.
        let along = sub(at_right, at_left).map(|x| x / edge);
        let away = [along[1], -along[0]];
        let at = [
            at_left[0] + beyond.x * along[0] + beyond.y * away[0],
            at_left[1] + beyond.x * along[1] + beyond.y * away[1],
        ];
        let ray = sub(at, apex);
        let (acute_to_a, acute_to_b) = (dot(ray, to_a) > 0.0, dot(ray, to_b) > 0.0);
        if acute_to_a && acute_to_b {
            return Unfolding::Split(Split {
                vertex,
                length: norm(ray),
                bases: [norm(sub(at, at_a)), norm(sub(at_b, at))],
            });
        }
        // The cone passes through the edge on the other side of the new vertex.
        let (corner_at_left, corner_at_right) =
            if starts_left { (next.next(), next.prev()) } else { (next.prev(), next.next()) };
        if acute_to_a {
            // Too far on the side of A: go on across the edge from the new vertex to the right end,
            // which faces the left one.
            (left, at_left, facing) = (vertex, at, corner_at_left);
        } else {
            (right, at_right, facing) = (vertex, at, corner_at_right);
        }
        if left == right {
            return Unfolding::Stopped;
        }
    }
    Unfolding::Stopped
}

#[cfg(test)]
mod tests {
    use surface::Topology;

    use super::*;

    /// Vertices in the plane and faces over them.
    fn flat(points: &[Point], faces: &[[u32; 3]]) -> IntrinsicMesh {
        let faces = faces.iter().map(|f| f.map(VertexId)).collect();
        let topology = Topology::new(points.len(), faces);
        let lengths =
            topology.edges().iter().map(|[a, b]| norm(sub(points[a.index()], points[b.index()]))).collect();
        IntrinsicMesh::new(topology, lengths)
    }

    #[test]
    fn splits_by_the_vertex_opposite() {
        let points = [[0.0, 0.4], [-2.0, 0.0], [2.0, 0.0], [0.2, -1.0]];
        let mesh = flat(&points, &[[0, 1, 2], [2, 1, 3]]);
        let Unfolding::Split(split) = unfold(&mesh, CornerId(0)) else { panic!("not split") };
        assert_eq!(split.vertex, VertexId(3));
        assert!((split.length - 0.2f64.hypot(1.4)).abs() < 1e-14);
        assert!((split.bases[0] - 2.2f64.hypot(1.0)).abs() < 1e-14);
        assert!((split.bases[1] - 1.8f64.hypot(1.0)).abs() < 1e-14);
        assert_eq!(unfold(&mesh, CornerId(1)), Unfolding::Acute);
    }

    #[test]
    fn walks_on_where_the_first_vertex_is_outside_the_cone_whatever_the_orientation() {
        // Vertex 3 lies far on A's side; vertex 4 behind it is inside the cone.
        let points = [[0.0, 0.4], [-2.0, 0.0], [2.0, 0.0], [-3.0, -0.5], [0.1, -2.0]];
        for second in [[2, 1, 3], [1, 2, 3], [3, 2, 1]] {
            for third in [[2, 3, 4], [4, 3, 2]] {
                let mesh = flat(&points, &[[0, 1, 2], second, third]);
                let Unfolding::Split(split) = unfold(&mesh, CornerId(0)) else { panic!("not split") };
                assert_eq!(split.vertex, VertexId(4));
                assert!((split.length - 0.1f64.hypot(2.4)).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn stops_at_a_boundary_and_at_a_non_manifold_edge() {
        let points = [[0.0, 0.4], [-2.0, 0.0], [2.0, 0.0], [0.3, -1.0], [0.2, -3.0]];
        assert_eq!(unfold(&flat(&points, &[[0, 1, 2]]), CornerId(0)), Unfolding::Stopped);
        let fan = flat(&points, &[[0, 1, 2], [2, 1, 3], [1, 2, 4]]);
        assert_eq!(unfold(&fan, CornerId(0)), Unfolding::Stopped);
    }
}
