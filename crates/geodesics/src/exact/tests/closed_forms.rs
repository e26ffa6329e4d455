//! Surfaces whose distances have a formula.

use std::f64::consts::PI;

use mesh::shapes;
use surface::{FaceId, VertexId};

use super::super::Exact;
use super::{all_pairs, apart, assert_close, cone, faces, points, spatial};
use crate::{DistanceSolver, Source, SurfacePoint};

/// Distance on the unit cube from `(p, q)` on the bottom to `(x, y)` on the top: the shortest of the straight lines
/// through one side or two.
fn bottom_to_top([p, q]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
    let mut shortest = f64::INFINITY;
    // Both mirror images, and both roles of the axes.
    for (p, x) in [(p, x), (1.0 - p, 1.0 - x)] {
        for (q, y) in [(q, y), (1.0 - q, 1.0 - y)] {
            for ([p, x], [q, y]) in [([p, x], [q, y]), ([q, y], [p, x])] {
                let one_side = (p + 1.0 + x).hypot(q - y);
                let two_sides = (q + x).hypot(p + 1.0 + y);
                shortest = shortest.min(one_side).min(two_sides);
            }
        }
    }
    shortest
}

#[test]
fn distances_on_a_cube_are_those_of_the_best_unfolding() {
    let cube = shapes::cube(2);
    let mesh = cube.intrinsic();
    let solver = Exact::new(&mesh, &());
    let top = |v: usize| (cube.positions[v].z == 1.0).then(|| [cube.positions[v].x, cube.positions[v].y]);
    let mut out = vec![0.0; cube.positions.len()];
    let mut sources = Vec::new();
    for (v, p) in cube.positions.iter().enumerate().filter(|(_, p)| p.z == 0.0) {
        sources.push((Source::vertex(VertexId::from(v)), [p.x, p.y]));
    }
    for (f, face) in cube.faces.iter().enumerate() {
        let [a, b, c] = face.map(|v| cube.positions[v.index()]);
        if a.z == 0.0 && b.z == 0.0 && c.z == 0.0 {
            let barycentric = [0.5, 0.3, 0.2];
            let at = a.coords * 0.5 + b.coords * 0.3 + c.coords * 0.2;
            let point = SurfacePoint::Face { face: FaceId::from(f), barycentric };
            sources.push((Source::new(&mesh, point).unwrap(), [at.x, at.y]));
        }
    }
    for (source, from) in sources {
        solver.solve_into(&[source], f64::INFINITY, &mut out).unwrap();
        for (v, found) in out.iter().enumerate() {
            if let Some(to) = top(v) {
                assert_close(*found, bottom_to_top(from, to), 1e-14);
            }
        }
    }
}

#[test]
fn paths_around_cones_take_the_shorter_side_and_bend_at_saddles() {
    for (n, total, is_closed) in [
        (12, 1.6 * PI, true),
        (12, 2.0 * PI, true),
        (14, 2.9 * PI, true),
        (16, 4.0 * PI, true),
        (10, 1.7 * PI, false),
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

#[test]
fn paths_bend_at_the_tip_of_a_slit() {
    // Cut from (5, 0) to (5, 6): the vertices below (5, 6) have copies for the faces to their right.
    let n = 11;
    let sheet = shapes::grid(n, n, 1.0);
    let (mut at, mut cut) = (points(&sheet), faces(&sheet));
    for j in 0..6usize {
        let (old, copy) = ((j * n + 5) as u32, at.len() as u32);
        at.push(at[old as usize]);
        for face in cut.iter_mut().filter(|f| f.iter().any(|v| at[*v as usize][0] > 5.0)) {
            face.iter_mut().filter(|v| **v == old).for_each(|v| *v = copy);
        }
    }
    let found = Exact::new(&spatial(&at, &cut), &()).distances(VertexId(3 * n as u32 + 2)).unwrap();
    let tip = 3f64.hypot(3.0);
    for (v, p) in at.iter().enumerate() {
        let is_right = p[0] > 5.0 || v >= n * n;
        // The line from (2, 3) passes above the tip from slope 1 on.
        let is_hidden = is_right && p[1] - 3.0 < p[0] - 2.0;
        let straight = (p[0] - 2.0).hypot(p[1] - 3.0);
        let bent = tip + (p[0] - 5.0).hypot(p[1] - 6.0);
        assert_close(found[v], if is_hidden { bent } else { straight }, 1e-14);
    }
}

#[test]
fn distances_from_points_on_edges_and_in_faces_are_euclidean() {
    let sheet = shapes::jittered_grid(9, 9, 1.0, 0.2, 8);
    let mesh = sheet.intrinsic();
    let solver = Exact::new(&mesh, &());
    let mut out = vec![0.0; mesh.n_vertices()];
    let mut check = |point: SurfacePoint, at: [f64; 2]| {
        solver.solve_into(&[Source::new(&mesh, point).unwrap()], f64::INFINITY, &mut out).unwrap();
        for (found, p) in out.iter().zip(&sheet.positions) {
            let expected = (p.x - at[0]).hypot(p.y - at[1]);
            assert!((found - expected).abs() < 1e-9 * expected.max(1.0), "{point:?}: {found} {expected}");
        }
    };
    for face in [0usize, 31, 64, 127].map(FaceId::from) {
        let corners = sheet.faces[face.index()].map(|v| sheet.positions[v.index()]);
        for barycentric in [
            [0.2, 0.5, 0.3],
            [1.0, 0.0, 0.0],
            [0.0, 0.4, 0.6],
            [0.5, 0.5, 0.0],
            [1e-13, 0.3, 0.7 - 1e-13],
            [1e-7, 1.0 - 2e-7, 1e-7],
            [1.0 - 2e-10, 1e-10, 1e-10],
        ] {
            let at = [0, 1].map(|axis| (0..3).map(|i| barycentric[i] * corners[i][axis]).sum());
            check(SurfacePoint::Face { face, barycentric }, at);
        }
    }
    for edge in [0usize, 50, 150].map(surface::EdgeId::from) {
        let [a, b] = mesh.topology().edges()[edge.index()].map(|v| sheet.positions[v.index()]);
        for t in [0.0, 0.25, 0.9, 1.0, 1e-14] {
            check(SurfacePoint::Edge { edge, t }, [a.x + t * (b.x - a.x), a.y + t * (b.y - a.y)]);
        }
    }
}
