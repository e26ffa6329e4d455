//! Laws on any surface.

use std::f64::consts::PI;

use mesh::shapes;
use proptest::prelude::*;
use surface::{FaceId, VertexId};

use super::{assert_path, shortest, vertex};
use crate::tests::properties::{ROUNDING, distances, left_open, soup, sources, tame};
use crate::tests::{all_triangles, assert_close, bumpy, cone, distances_from};
use crate::{Dijkstra, DistanceSolver, Exact, FastMarching, PathTracer, Source, SurfacePoint};

#[test]
fn exact_distances_give_exactly_shortest_paths_between_all_pairs() {
    let hilly = [(8, 0.5, 1), (9, 0.9, 3), (7, 2.0, 5)].map(|(n, height, seed)| bumpy(n, height, seed));
    let flat = [
        shapes::grid(7, 6, 0.5),
        shapes::sheared_grid(7, 6, 0.5, 6.0),
        shapes::jittered_grid(7, 6, 0.5, 0.24, 3),
    ];
    let convex = [shapes::cube(0), shapes::cube(2), shapes::cylinder(12, 4, 1.0, 3.0)];
    let shapes = flat.into_iter().chain(convex).map(|mesh| mesh.intrinsic());
    // Paths that bend at a boundary, and across edges of several faces.
    let others = [cone(14, 3.1 * PI, 3, false).0, all_triangles(5), all_triangles(6)];
    for mesh in hilly.into_iter().chain(shapes).chain(others) {
        let solver = Exact::new(&mesh, &());
        for source in (0..mesh.n_vertices()).map(VertexId::from) {
            let distances = solver.distances(source).unwrap();
            let sources = [Source::vertex(source)];
            let tracer = PathTracer::new(&mesh, &sources, &distances, &());
            for (target, distance) in distances.iter().enumerate() {
                let path = tracer.path_to(vertex(target)).unwrap();
                assert_path(&mesh, &path, SurfacePoint::Vertex(source), vertex(target));
                assert_close(path.length, *distance, 1e-11);
            }
        }
    }
}

#[test]
fn distances_with_a_limit_give_the_same_paths_within_it() {
    let mesh = bumpy(12, 0.8, 6);
    let solver = Exact::new(&mesh, &());
    let sources = [Source::vertex(VertexId(60))];
    let [full, limited] = [f64::INFINITY, 4.0].map(|limit| distances_from(&solver, &sources, limit));
    let [all, some] = [&full, &limited].map(|field| PathTracer::new(&mesh, &sources, field, &()));
    for (v, distance) in full.iter().enumerate() {
        match some.path_to(vertex(v)) {
            Ok(path) => assert_close(path.length, all.path_to(vertex(v)).unwrap().length, 1e-12),
            Err(_) => assert!(*distance > 4.0),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, failure_persistence: None, ..Default::default() })]

    #[test]
    fn paths_between_any_points_are_as_long_in_either_direction(
        is_hilly: bool, faces in prop::array::uniform2(0..162usize),
        weights in prop::array::uniform6(prop_oneof![Just(0.0), Just(1e-14), 0.01..1.0f64]),
    ) {
        let mesh = if is_hilly { bumpy(10, 1.2, 4) } else { all_triangles(6) };
        let [p, q] = [0, 1].map(|i| {
            let weights = &weights[3 * i..3 * i + 3];
            let sum: f64 = weights.iter().sum();
            let barycentric = if sum > 0.01 { [0, 1, 2].map(|i| weights[i] / sum) } else { [0.2, 0.3, 0.5] };
            let face = FaceId::from(faces[i] % mesh.topology().n_faces());
            SurfacePoint::Face { face, barycentric }.simplified(&mesh)
        });
        let [there, back] = [shortest(&mesh, p, q), shortest(&mesh, q, p)].map(|path| path.length);
        prop_assert!((there - back).abs() <= 1e-11 * (1.0 + back), "{there} {back}");
    }

    #[test]
    fn any_field_gives_paths_between_the_exact_distance_and_that_along_edges(
        mesh in prop_oneof![soup(), tame()],
    ) {
        let surface = mesh.intrinsic();
        // Exact distances may miss paths through faces with a side of length zero, which repair drops.
        prop_assume!(surface.edge_lengths().iter().all(|length| *length > 0.0));
        let (n, open) = (mesh.n_vertices(), left_open(&surface));
        let marching = FastMarching::new(&surface, Default::default(), &());
        let (exact, dijkstra) = (Exact::new(&surface, &()), Dijkstra::new(&surface, &()));
        let nonsense: Vec<f64> = (0..n).map(|v| ((v * 7919) % 101) as f64).collect();
        for source in sources(&mesh).take(3) {
            let Some(exact) = distances(&exact, &surface, source) else { continue };
            let solvers: [&dyn DistanceSolver; 2] = [&marching, &dijkstra];
            let [marched, along_edges] = solvers.map(|solver| solver.distances(source).unwrap());
            let sources = [Source::vertex(source)];
            // Where distances are not exact, a path may take as long as its limit of rays.
            for (field, most) in [(&exact, n), (&marched, 2), (&nonsense, 1), (&vec![0.0; n], 1)] {
                let tracer = PathTracer::new(&surface, &sources, field, &());
                for v in (0..n).rev().filter(|v| along_edges[*v].is_finite()).take(most) {
                    let path = tracer.path_to(vertex(v)).unwrap();
                    assert_path(&surface, &path, SurfacePoint::Vertex(source), vertex(v));
                    prop_assert!(path.length >= exact[v] - open, "{} {}", path.length, exact[v]);
                    // The field may claim more than the distance along edges.
                    let limit = along_edges[v].max(field[v]);
                    prop_assert!(path.length <= limit * (1.0 + ROUNDING), "{} {limit}", path.length);
                }
            }
        }
    }
}
