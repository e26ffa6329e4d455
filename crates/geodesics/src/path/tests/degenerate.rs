//! Surfaces that are hardly any.

use mesh::shapes;
use proptest::prelude::*;
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use super::{assert_path, vertex};
use crate::tests::{impossible, lengths_of_nothing, pinched, spatial};
use crate::{Dijkstra, DistanceSolver, Exact, PathTracer, Source, SurfacePoint};

/// Every path is one, and no longer than along edges, or there is none.
fn assert_sane(mesh: &IntrinsicMesh) {
    let dijkstra = Dijkstra::new(mesh, &());
    let solvers: [&dyn DistanceSolver; 2] = [&Exact::new(mesh, &()), &dijkstra];
    for source in (0..mesh.n_vertices()).step_by(3) {
        let along_edges = dijkstra.distances(VertexId::from(source)).unwrap();
        for solver in solvers {
            let sources = [Source::vertex(VertexId::from(source))];
            let field = match solver.distances(VertexId::from(source)) {
                Err(base::Exceeded::Steps { .. }) => continue,
                field => field.unwrap(),
            };
            let tracer = PathTracer::new(mesh, &sources, &field, &());
            for (target, limit) in along_edges.iter().enumerate() {
                match tracer.path_to(vertex(target)) {
                    Err(_) => assert!(limit.is_infinite()),
                    Ok(path) => {
                        assert_path(mesh, &path, vertex(source), vertex(target));
                        assert!(path.length <= limit * (1.0 + 1e-12), "{} {limit}", path.length);
                    }
                }
            }
        }
    }
}

#[test]
fn repeated_faces_change_no_path() {
    let sheet = shapes::jittered_grid(5, 4, 1.0, 0.2, 2);
    for copies in [2, 3] {
        let repeated = mesh::TriMesh { faces: sheet.faces.repeat(copies), ..sheet.clone() };
        assert_sane(&repeated.intrinsic());
    }
}

#[test]
fn paths_around_a_needle_are_found() {
    let mut at = vec![[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [0.0, 0.0, 3.0]];
    let mut tube = Vec::new();
    for i in 0..7u32 {
        let angle = std::f64::consts::TAU * f64::from(i) / 7.0;
        at.push([1e-7 * angle.cos(), 1e-7 * angle.sin(), 0.1 * angle.sin()]);
        let (a, b) = (3 + i, 3 + (i + 1) % 7);
        tube.extend([[0, a, b], [b, a, 1]]);
    }
    tube.push([0, 2, 3]);
    assert_sane(&spatial(&at, &tube));
}

#[test]
fn an_isolated_vertex_reaches_itself() {
    let mesh = IntrinsicMesh::new(Topology::new(2, Vec::new()), Vec::new());
    assert_sane(&mesh);
    assert_sane(&mesh.with_links(vec![Link { ends: [0, 1].map(VertexId), length: 1.0 }]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

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
