//! Laws on any surface.

use mesh::shapes;
use surface::{EdgeId, FaceId, VertexId};

use super::{assert_path, vertex};
use crate::tests::{assert_close, bumpy, faces, points, spatial};
use crate::{Dijkstra, DistanceSolver, Exact, FastMarching, HeatMethod, PathTracer, Source, SurfacePoint};

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
    for mesh in hilly.into_iter().chain(shapes) {
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
fn paths_between_points_of_edges_and_faces_are_symmetric() {
    let mesh = bumpy(10, 1.2, 4);
    let edge = |edge: u32, t| SurfacePoint::Edge { edge: EdgeId(edge), t };
    let face = |face: u32, barycentric| SurfacePoint::Face { face: FaceId(face), barycentric };
    let all = [
        vertex(44),
        edge(3, 0.3),
        edge(150, 0.999),
        edge(200, 0.5),
        face(0, [0.2, 0.3, 0.5]),
        face(80, [1e-9, 0.5, 0.5 - 1e-9]),
        face(131, [0.0, 0.6, 0.4]),
        face(160, [0.1, 0.8, 0.1]),
    ];
    for p in all {
        for q in all {
            let [there, back] = [(p, q), (q, p)].map(|(source, target)| {
                let sources = [Source::new(&mesh, source).unwrap()];
                let mut distances = vec![0.0; mesh.n_vertices()];
                Exact::new(&mesh, &()).solve_into(&sources, f64::INFINITY, &mut distances).unwrap();
                PathTracer::new(&mesh, &sources, &distances, &()).path_to(target).unwrap().length
            });
            assert_close(there, back, 1e-11);
        }
    }
}

#[test]
fn any_field_gives_a_path_between_the_exact_distance_and_that_along_edges() {
    let sphere = shapes::icosphere(2);
    let mut at = points(&sphere);
    for p in &mut at {
        p[0] *= 2.0 + 0.6 * (3.0 * p[1]).sin();
        p[2] *= 1.0 + 0.3 * (5.0 * p[0]).cos();
    }
    let mesh = spatial(&at, &faces(&sphere));
    let (exact, dijkstra) = (Exact::new(&mesh, &()), Dijkstra::new(&mesh, &()));
    let solvers: [&dyn DistanceSolver; 5] = [
        &exact,
        &FastMarching::new(&mesh, Default::default(), &()),
        &HeatMethod::new(&mesh, Default::default(), &()).unwrap(),
        &dijkstra,
        &Dijkstra::of_hops(&mesh, &()),
    ];
    for source in [0, 101].map(VertexId) {
        let (shortest, along_edges) = (exact.distances(source).unwrap(), dijkstra.distances(source).unwrap());
        let nonsense = (0..mesh.n_vertices()).map(|v| ((v * 7919) % 101) as f64).collect();
        let nothing = vec![0.0; mesh.n_vertices()];
        let fields =
            solvers.map(|solver| solver.distances(source).unwrap()).into_iter().chain([nonsense, nothing]);
        for field in fields {
            let sources = [Source::vertex(source)];
            let tracer = PathTracer::new(&mesh, &sources, &field, &());
            for target in (0..mesh.n_vertices()).step_by(4) {
                let path = tracer.path_to(vertex(target)).unwrap();
                assert_path(&mesh, &path, SurfacePoint::Vertex(source), vertex(target));
                assert!(path.length >= shortest[target] * (1.0 - 1e-12), "{}", path.length);
                // The field may claim more than the distance along edges.
                let limit = along_edges[target].max(field[target]);
                assert!(path.length <= limit * (1.0 + 1e-12), "{} {limit}", path.length);
            }
        }
    }
}

#[test]
fn distances_with_a_limit_give_the_same_paths_within_it() {
    let mesh = bumpy(12, 0.8, 6);
    let solver = Exact::new(&mesh, &());
    let sources = [Source::vertex(VertexId(60))];
    let (full, mut limited) = (solver.distances(VertexId(60)).unwrap(), vec![0.0; mesh.n_vertices()]);
    solver.solve_into(&sources, 4.0, &mut limited).unwrap();
    let [all, some] = [&full, &limited].map(|field| PathTracer::new(&mesh, &sources, field, &()));
    for (v, distance) in full.iter().enumerate() {
        match some.path_to(vertex(v)) {
            Ok(path) => assert_close(path.length, all.path_to(vertex(v)).unwrap().length, 1e-12),
            Err(_) => assert!(*distance > 4.0),
        }
    }
}
