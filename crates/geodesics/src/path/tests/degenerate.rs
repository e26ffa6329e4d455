//! Surfaces that are hardly any.

use mesh::shapes;
use proptest::prelude::*;
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use super::{assert_path, vertex};
use crate::tests::{faces, spatial};
use crate::{Dijkstra, DistanceSolver, Exact, PathTracer, Source};

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
                // Paths from one source in three to one target in three are enough.
                if source.0 % 3 == 0 && target % 3 == 1 {
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

/// Lengths that violate the triangle inequality as a rule.
fn lengths_of_nothing() -> impl Strategy<Value = f64> {
    prop_oneof![
        0.5..1.5f64,
        Just(0.0),
        Just(1.0),
        Just(1e-300),
        Just(1e-14),
        0.0..1e-9f64,
        Just(7.0),
        Just(2.0)
    ]
}

/// Faces between nine vertices, with such lengths.
fn impossible() -> impl Strategy<Value = IntrinsicMesh> {
    let raw = prop::collection::vec((0..9u32, 1..9u32, 0..9u32), 1..30);
    (raw, prop::collection::vec(lengths_of_nothing(), 40)).prop_map(|(raw, lengths)| {
        let faces = raw.iter().map(|(a, b, c)| [*a, (a + b) % 9, *c]).filter(|[a, b, c]| a != c && b != c);
        let topology = Topology::new(9, faces.map(|f| f.map(VertexId)).collect());
        let lengths = lengths[..topology.n_edges()].to_vec();
        IntrinsicMesh::new(topology, lengths)
    })
}

/// A sheet over points of a 3 x 3 x 3 lattice, hardly moved: collinear, coplanar, coincident.
fn pinched(nx: usize, ny: usize) -> impl Strategy<Value = IntrinsicMesh> {
    let picks = prop::collection::vec((0..27usize, prop::array::uniform3(-1.0..1.0f64)), nx * ny);
    let scale = prop_oneof![Just(0.0), Just(1e-16), Just(1e-13), Just(1e-8), Just(1e-3)];
    (picks, scale).prop_map(move |(picks, scale)| {
        let at = |(pick, by): &(usize, [f64; 3])| {
            [0, 1, 2].map(|i| (pick / 3usize.pow(i as u32) % 3) as f64 + scale * by[i])
        };
        let at: Vec<[f64; 3]> = picks.iter().map(at).collect();
        spatial(&at, &faces(&shapes::grid(nx, ny, 1.0)))
    })
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
}
