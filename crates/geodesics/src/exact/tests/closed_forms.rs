//! Surfaces whose distances have a formula.

use mesh::shapes;
use surface::{FaceId, IntrinsicMesh, Topology, VertexId};

use super::super::Exact;
use super::{all_pairs, assert_close};
use crate::{DistanceSolver, Source, SurfacePoint};

#[test]
fn distances_on_flat_sheets_are_euclidean_for_any_triangles() {
    for (sheet, tolerance) in [
        (shapes::grid(15, 12, 0.7), 1e-14),
        (shapes::sheared_grid(14, 15, 1.0, 2.3), 1e-13),
        (shapes::sheared_grid(12, 12, 1.0, -9.5), 1e-12),
        (shapes::jittered_grid(20, 18, 1e-3, 0.24, 5), 1e-13),
    ] {
        let solver = Exact::new(&sheet.intrinsic(), &());
        for source in [0, 17, 100, 143] {
            let from = sheet.positions[source];
            for (found, p) in solver.distances(VertexId::from(source)).unwrap().iter().zip(&sheet.positions) {
                assert_close(*found, (p - from).norm(), tolerance);
            }
        }
    }
}

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

/// Flat rings of `n` sectors with the angle `alpha` around vertex 0, closed or open, by their lengths alone: ring
/// `r`, sector `s` is vertex `1 + r * spokes + s`.
fn cone(n: usize, alpha: f64, n_rings: usize, is_closed: bool) -> IntrinsicMesh {
    let spokes = if is_closed { n } else { n + 1 };
    let at = |ring: usize, sector: usize| (1 + ring * spokes + sector % spokes) as u32;
    let mut faces = Vec::new();
    for s in 0..n {
        faces.push([0, at(0, s), at(0, s + 1)]);
        for r in 1..n_rings {
            faces.push([at(r - 1, s), at(r, s), at(r, s + 1)]);
            faces.push([at(r - 1, s), at(r, s + 1), at(r - 1, s + 1)]);
        }
    }
    let topology = Topology::new(1 + n_rings * spokes, faces.iter().map(|f| f.map(VertexId)).collect());
    let polar = |v: VertexId| match v.index() {
        0 => (0.0, 0),
        v => (((v - 1) / spokes + 1) as f64, (v - 1) % spokes),
    };
    let lengths = topology.edges().iter().map(|[a, b]| {
        let ((p, s), (q, t)) = (polar(*a), polar(*b));
        if s == t || p == 0.0 { (p - q).abs() } else { apart(p, q, alpha) }
    });
    let lengths = lengths.collect();
    IntrinsicMesh::new(topology, lengths)
}

/// Distance of two points at these distances from the origin, at this angle.
fn apart(p: f64, q: f64, angle: f64) -> f64 {
    ((p - q).powi(2) + 4.0 * p * q * (0.5 * angle).sin().powi(2)).sqrt()
}

#[test]
fn paths_around_cones_take_the_shorter_side_and_bend_at_saddles() {
    use std::f64::consts::PI;
    for (n, total, is_closed) in [
        (12, 1.6 * PI, true),
        (12, 2.0 * PI, true),
        (14, 2.9 * PI, true),
        (16, 4.0 * PI, true),
        (10, 1.7 * PI, false),
        (10, 1.0 * PI, false),
        (14, 3.1 * PI, false),
    ] {
        let (n_rings, alpha) = (4, total / n as f64);
        let spokes = if is_closed { n } else { n + 1 };
        let mesh = cone(n, alpha, n_rings, is_closed);
        let found = all_pairs(&mesh);
        for (v, row) in found.iter().enumerate().skip(1) {
            assert_close(row[0], ((v - 1) / spokes + 1) as f64, 1e-14);
            for (w, found) in row.iter().enumerate().skip(1) {
                let [(p, s), (q, t)] = [v, w].map(|v| (((v - 1) / spokes + 1) as f64, (v - 1) % spokes));
                let sectors = s.abs_diff(t);
                let sectors = if is_closed { sectors.min(n - sectors) } else { sectors };
                let angle = sectors as f64 * alpha;
                let expected = if angle >= PI { p + q } else { apart(p, q, angle) };
                assert_close(*found, expected, 1e-13);
            }
        }
    }
}

#[test]
fn refining_a_surface_does_not_change_it() {
    let sphere = shapes::icosphere(1);
    let coarse = all_pairs(&sphere.intrinsic());
    let fine = shapes::subdivide(&shapes::subdivide(&sphere));
    let solver = Exact::new(&fine.intrinsic(), &());
    for (v, row) in coarse.iter().enumerate() {
        let refined = solver.distances(VertexId::from(v)).unwrap();
        for (found, expected) in refined.iter().zip(row) {
            assert_close(*found, *expected, 1e-12);
        }
    }
}
