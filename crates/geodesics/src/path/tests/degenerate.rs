//! Surfaces that are hardly any.

use mesh::shapes;
use proptest::prelude::*;
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use super::{assert_path, vertex};
use crate::tests::{impossible, lengths_of_nothing, pinched, spatial};
use crate::{Dijkstra, DistanceSolver, Exact, PathTracer, Source, SurfacePoint};

/// No distance is missing, negative or longer than along the edges; every path is one, and no longer than along edges, or
/// there is none.
fn assert_sane(mesh: &IntrinsicMesh) {
    let dijkstra = Dijkstra::new(mesh, &());
    let solvers: [&dyn DistanceSolver; 2] = [&Exact::new(mesh, &()), &dijkstra];
    for source in (0..mesh.n_vertices()).map(VertexId::from) {
        let along_edges = dijkstra.distances(source).unwrap();
        for solver in solvers {
            let sources = [Source::vertex(source)];
            let field = match solver.distances(source) {
                // Lengths of no surface in space may need any number of windows.
                Err(base::Exceeded::Steps { .. }) => continue,
                field => field.unwrap(),
            };
            let tracer = PathTracer::new(mesh, &sources, &field, &());
            for (target, (limit, found)) in along_edges.iter().zip(&field).enumerate() {
                assert!(*found >= 0.0 && *found <= limit * (1.0 + 1e-12), "{found} {limit}");
                assert_eq!(found.is_finite(), limit.is_finite());
                // Paths from one source in three are enough.
                if source.0 % 3 == 0 {
                    match tracer.path_to(vertex(target)) {
                        Err(_) => assert!(limit.is_infinite()),
                        Ok(path) => {
                            assert_path(mesh, &path, vertex(source.index()), vertex(target));
                            assert!(path.length <= limit * (1.0 + 1e-12), "{} {limit}", path.length);
                        }
                    }
                }
            }
        }
    }
}

#[test]
fn windows_around_a_thin_needle_come_to_an_end_and_paths_are_found() {
    // A double cone with n needles and a total angle far below a full turn at either tip.
    for (n, width) in [(3, 1e-3), (3, 1e-5), (7, 1e-7), (5, 1e-8), (40, 1e-3)] {
        let mut at = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 3.0]];
        let mut tube = Vec::new();
        for i in 0..n {
            let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
            at.push([width * angle.cos(), width * angle.sin(), 0.1 * angle.sin()]);
            let (a, b) = (3 + i, 3 + (i + 1) % n);
            tube.extend([[0, a, b], [b, a, 1]]);
        }
        tube.push([0, 2, 3]);
        assert_sane(&spatial(&at, &tube));
    }
}

#[test]
fn an_isolated_vertex_reaches_itself() {
    let mesh = IntrinsicMesh::new(Topology::new(2, Vec::new()), Vec::new());
    assert_sane(&mesh);
    assert_sane(&mesh.with_links(vec![Link { ends: [0, 1].map(VertexId), length: 1.0 }]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn impossible_lengths_do_no_harm(
        mesh in impossible(), link in prop::option::of((0..9u32, lengths_of_nothing())),
    ) {
        let link = link.map(|(a, length)| Link { ends: [a, (a + 4) % 9].map(VertexId), length });
        assert_sane(&mesh.with_links(link.into_iter().collect()));
    }

    #[test]
    fn vertices_in_the_same_places_do_no_harm(mesh in pinched(5, 4)) {
        assert_sane(&mesh);
    }

    #[test]
    fn points_anywhere_have_paths(
        face in 0..80u32, other in 0..80u32,
        weights in prop::array::uniform6(prop_oneof![Just(0.0), Just(1e-14), 0.01..1.0f64]),
    ) {
        let mesh = shapes::icosphere(1).intrinsic();
        let point = |face, weights: &[f64]| {
            let sum: f64 = weights.iter().sum();
            let barycentric = if sum > 0.01 { [0, 1, 2].map(|i| weights[i] / sum) } else { [0.2, 0.3, 0.5] };
            SurfacePoint::Face { face: surface::FaceId(face), barycentric }
        };
        let (p, q) = (point(face, &weights[..3]), point(other, &weights[3..]));
        let sources = [Source::new(&mesh, p).unwrap()];
        let mut field = vec![0.0; mesh.n_vertices()];
        Exact::new(&mesh, &()).solve_into(&sources, f64::INFINITY, &mut field).unwrap();
        let path = PathTracer::new(&mesh, &sources, &field, &()).path_to(q).unwrap();
        assert_path(&mesh, &path, path.points[0], *path.points.last().unwrap());
        assert!(path.length < 4.0);
    }
}
