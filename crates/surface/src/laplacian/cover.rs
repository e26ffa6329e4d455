//! The double cover of a surface of any topology.

use crate::ids::{CornerId, EdgeId, FaceId, VertexId};
use crate::intrinsic::IntrinsicMesh;
use crate::triangulation::Triangulation;

/// The tufted cover of a mesh with given edge lengths (Sharp and Crane 2020, `sharp2020`): a closed, oriented
/// surface.
///
/// Every face has a front and a back. Around an edge, the front of each face is glued to the back of the next. So all
/// sides can be flipped, at the boundary, at non-manifold edges and between faces of opposite orientation.
pub(super) fn tufted_cover(mesh: &IntrinsicMesh, edge_lengths: &[f64]) -> Triangulation {
    let topology = mesh.topology();
    let fronts = topology.faces().iter().map(|[a, b, c]| [*c, *a, *b]);
    let backs = topology.faces().iter().map(|[a, b, c]| [*b, *a, *c]);
    let mut cover = Triangulation::loose(fronts.chain(backs));
    // The corners of front and back opposite the edge that a corner of the mesh is opposite to: first the one whose
    // side starts at `lower`.
    let sides_at = |corner: CornerId, lower: VertexId| {
        let back = FaceId::from(topology.n_faces() + corner.face().index());
        let sides = [corner.next(), CornerId::new(back, [1, 0, 2][corner.slot()])];
        if topology.corner_vertex(corner.next()) == lower { sides } else { [sides[1], sides[0]] }
    };
    for (e, ([lower, _], length)) in topology.edges().iter().zip(edge_lengths).enumerate() {
        let corners = topology.edge_corners(EdgeId::from(e));
        for (corner, next) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            let [rising, falling] = sides_at(*corner, *lower);
            let [_, next_falling] = sides_at(*next, *lower);
            cover.glue(rising, next_falling);
            cover.set_length(rising, *length);
            cover.set_length(falling, *length);
        }
    }
    cover
}

#[cfg(test)]
mod tests {
    use mesh::shapes;

    use super::*;
    use crate::testing::intrinsic;
    use crate::topology::Topology;
    use crate::triangulation::Loops;
    use crate::triangulation::tests::{area, assert_delaunay};

    /// The cover before and after all flips.
    fn covers(mesh: &IntrinsicMesh) -> [Triangulation; 2] {
        let cover = tufted_cover(mesh, mesh.edge_lengths());
        let mut flipped = cover.clone();
        flipped.flip_to_delaunay(Loops::Allowed);
        assert_delaunay(&flipped);
        for corner in (0..3 * cover.triangles().len()).map(CornerId::from) {
            for cover in [&cover, &flipped] {
                let far = cover.opposite(corner).unwrap();
                assert_eq!(cover.corner_vertex(corner.next()), cover.corner_vertex(far.prev()));
                assert_eq!(cover.corner_vertex(corner.prev()), cover.corner_vertex(far.next()));
            }
        }
        [cover, flipped]
    }

    #[test]
    fn the_cover_is_closed_and_oriented_and_its_area_is_kept_by_flips() {
        for (mesh, tolerance) in [
            (shapes::sheared_grid(12, 9, 1.0, 4.3), 1e-12),
            (shapes::jittered_grid(14, 14, 1.0, 0.24, 5), 1e-12),
            (shapes::torus(30, 4, 2.0, 0.5), 1e-12),
            (shapes::cylinder(5, 40, 1.0, 2.0), 1e-12),
            (shapes::tetrahedron(2), 1e-12),
            (sliver_strip(), 1e-6),
        ] {
            let [before, after] = covers(&intrinsic(&mesh));
            assert!((area(&after) / area(&before) - 1.0).abs() < tolerance);
        }
    }

    /// A thin strip with caps of 179.99 degrees along both sides.
    fn sliver_strip() -> mesh::TriMesh {
        let mut sheet = shapes::grid(30, 2, 1.0);
        for p in &mut sheet.positions {
            p.x += if p.y > 0.5 { 7.3 } else { 0.0 };
            p.y *= 1e-3;
        }
        sheet
    }

    #[test]
    fn edges_of_any_kind_are_glued() {
        let fan: &[[u32; 3]] = &[[0, 1, 2], [0, 1, 3], [1, 0, 4]];
        let moebius: &[[u32; 3]] = &[[0, 1, 2], [1, 2, 3], [2, 3, 4], [3, 4, 0], [4, 0, 1]];
        let doubled: &[[u32; 3]] = &[[0, 1, 2], [0, 1, 2], [2, 1, 0]];
        for faces in [fan, moebius, doubled] {
            let topology = Topology::new(5, faces.iter().map(|f| f.map(VertexId)).collect());
            // Sides of different lengths, some corners obtuse.
            let lengths = (0..topology.n_edges()).map(|e| 1.0 + 0.13 * (e * e % 7) as f64).collect();
            covers(&IntrinsicMesh::new(topology, lengths));
        }
    }
}
