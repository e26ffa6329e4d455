//! Surfaces whose distances have a formula, or are those of another surface.

use std::f64::consts::PI;

use mesh::shapes;
use surface::{FaceId, IntrinsicMesh, Topology};

use super::super::Exact;
use super::{all_pairs, assert_close, bumpy, faces, points, spatial};
use crate::tests::{apart, cone, distances_from};
use crate::{Source, SurfacePoint};

/// A flat sheet whose distances must stay Euclidean when vertices are added.
fn assert_flat(points: &[[f64; 3]], faces: &[[u32; 3]], relative: f64) {
    for (v, row) in all_pairs(&spatial(points, faces)).iter().enumerate() {
        for (w, found) in row.iter().enumerate() {
            let [p, q] = [points[v], points[w]];
            assert_close(*found, (p[0] - q[0]).hypot(p[1] - q[1]), relative);
        }
    }
}

#[test]
fn flat_sheets_are_euclidean_for_any_triangles() {
    let jittered = shapes::jittered_grid(8, 8, 1.0, 0.24, 1);
    let [sheared, needles] = [2.3, -9.5].map(|shear| shapes::sheared_grid(9, 8, 1.0, shear));
    // The lengths of needles say less and less about their heights.
    for (sheet, stretch, relative) in [
        (&shapes::grid(9, 8, 0.7), 1.0, 1e-14),
        (&jittered, 1e-3, 1e-9),
        (&jittered, 1.0, 1e-13),
        (&sheared, 1.0, 1e-13),
        (&needles, 1.0, 1e-12),
        (&jittered, 30.0, 1e-12),
        (&jittered, 1e3, 1e-9),
        (&jittered, 1e5, 1e-5),
    ] {
        let mut at = points(sheet);
        at.iter_mut().for_each(|p| p[0] *= stretch);
        assert_flat(&at, &faces(sheet), relative);
    }
}

#[test]
fn repeated_faces_and_pillows_have_the_distances_of_one_sheet() {
    let sheet = bumpy(9, 0.8, 6);
    let faces = sheet.topology().faces();
    let expected = all_pairs(&sheet);
    for copies in 2..=4 {
        // Corners of a copy in another order, and in every other copy of the other orientation.
        let copy =
            |k: usize| faces.iter().map(move |[a, b, c]| [[*a, *b, *c], [*b, *a, *c], [*c, *a, *b]][k % 3]);
        let topology = Topology::new(sheet.n_vertices(), (0..copies).flat_map(copy).collect());
        let repeated = IntrinsicMesh::new(topology, sheet.edge_lengths().to_vec());
        assert_eq!(all_pairs(&repeated), expected);

        let solve = |mesh: &IntrinsicMesh, face: usize, barycentric: [f64; 3]| {
            let point = SurfacePoint::Face { face: FaceId::from(face), barycentric };
            distances_from(&Exact::new(mesh, &()), &[Source::new(mesh, point).unwrap()], f64::INFINITY)
        };
        for [s, t, u] in [[0.2, 0.3, 0.5], [0.6, 0.4, 0.0], [0.0, 0.3, 0.7]] {
            let expected = solve(&sheet, 50, [s, t, u]);
            for k in 1..copies {
                let found = solve(&repeated, 50 + k * faces.len(), [[s, t, u], [t, s, u], [u, s, t]][k % 3]);
                for (found, expected) in found.iter().zip(&expected) {
                    assert_close(*found, *expected, 1e-14);
                }
            }
        }
    }
}

#[test]
fn edges_without_length_are_points() {
    // A sheet whose column 3 is doubled, with faces of no width in between.
    let (n, m) = (8, 6);
    let sheet = shapes::grid(n, m, 1.0);
    let mut at = points(&sheet);
    at.iter_mut().filter(|p| p[0] > 3.0).for_each(|p| p[0] -= 1.0);
    assert_flat(&at, &faces(&sheet), 1e-12);
}

#[test]
fn paths_around_cones_take_the_shorter_side_and_bend_at_saddles() {
    for (n, total, is_closed) in [
        (12, 1.6 * PI, true),
        (12, 2.0 * PI, true),
        (14, 2.9 * PI, true),
        (16, 4.0 * PI, true),
        (10, 1.7 * PI, false),
        // The tip of a slit.
        (12, 2.0 * PI, false),
        (10, 1.0 * PI, false),
        (14, 3.1 * PI, false),
    ] {
        let (mesh, polar) = cone(n, total, 4, is_closed);
        for (row, [p, a]) in all_pairs(&mesh).iter().zip(&polar).skip(1) {
            assert_close(row[0], *p, 1e-14);
            for (found, [q, b]) in row.iter().zip(&polar).skip(1) {
                let angle = (a - b).abs();
                let angle = if is_closed { angle.min(total - angle) } else { angle };
                // Rounding of angles does not move a point beyond the apex.
                let expected = if angle > PI - 1e-9 { p + q } else { apart(*p, *q, angle) };
                assert_close(*found, expected, 1e-13);
            }
        }
    }
}
