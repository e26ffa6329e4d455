//! Laws of all distance solvers, through the trait: a new method needs one line in [`promises`].

use mesh::shapes;
use surface::{IntrinsicMesh, Link, Topology, VertexId};

use super::{bumpy, longest_edge, methods};
use crate::{DistanceSolver, Method, Source};

/// What a method promises beyond what all do.
struct Promises {
    /// By how much distances may deviate from those of a metric, in lengths of the longest edge.
    slack: f64,
    /// Share of a distance that rounding may take or add.
    rounding: f64,
    /// Whether no distance grows faster than along an edge.
    is_lipschitz: bool,
    /// Whether no distance is below the exact one.
    is_upper_bound: bool,
    /// Whether a limit changes no distance below it.
    has_exact_limit: bool,
}

fn promises(method: Method) -> Promises {
    let metric = Promises {
        slack: 0.0,
        rounding: 1e-12,
        is_lipschitz: true,
        is_upper_bound: true,
        has_exact_limit: true,
    };
    match method {
        // Triangles that are solved from vertices beyond the limit may be missing below it.
        Method::FastMarching(_) => {
            Promises { slack: 0.5, is_upper_bound: false, has_exact_limit: false, ..metric }
        }
        Method::Heat(_) => {
            Promises { slack: 1.0, rounding: 1e-9, is_lipschitz: false, is_upper_bound: false, ..metric }
        }
        Method::Exact | Method::Dijkstra => metric,
        // Hops may be shorter or longer than the edges.
        Method::BreadthFirst => Promises { is_lipschitz: false, is_upper_bound: false, ..metric },
    }
}

/// Every method, prepared for a surface, and its promises.
fn solvers(surface: &IntrinsicMesh) -> Vec<(&'static str, Promises, Box<dyn DistanceSolver>)> {
    let prepare = |(name, method): (&'static str, Method)| {
        (name, promises(method), method.prepare(surface, &()).unwrap())
    };
    methods().into_iter().map(prepare).collect()
}

/// A hilly sheet of 12 x 12 vertices with saddle vertices and obtuse corners.
fn hills(seed: u64) -> IntrinsicMesh {
    bumpy(12, 0.9, seed)
}

fn surfaces() -> [IntrinsicMesh; 3] {
    [hills(3), hills(8), shapes::torus(24, 12, 2.0, 0.7).intrinsic()]
}

fn solve(solver: &dyn DistanceSolver, sources: &[u32], max_distance: f64) -> Vec<f64> {
    let sources: Vec<Source> = sources.iter().map(|v| Source::vertex(VertexId(*v))).collect();
    let mut out = vec![0.0; solver.n_vertices()];
    solver.solve_into(&sources, max_distance, &mut out).unwrap();
    out
}

#[track_caller]
fn assert_close(found: &[f64], expected: &[f64], relative: f64, absolute: f64, name: &str) {
    assert_eq!(found.len(), expected.len());
    for (v, (found, expected)) in found.iter().zip(expected).enumerate() {
        let is_close = found == expected || (found - expected).abs() <= relative * expected.abs() + absolute;
        assert!(is_close, "{name}, vertex {v}: {found} instead of {expected}");
    }
}

#[test]
fn distances_are_zero_at_the_source_symmetric_and_satisfy_the_triangle_inequality() {
    for surface in surfaces() {
        for (name, promises, solver) in solvers(&surface) {
            let slack = promises.slack * longest_edge(&surface);
            let all: Vec<Vec<f64>> =
                (0..surface.n_vertices()).map(|v| solver.distances(VertexId::from(v)).unwrap()).collect();
            for (v, row) in all.iter().enumerate() {
                assert!(row.iter().enumerate().all(|(w, d)| (*d == 0.0) == (v == w) && *d >= 0.0), "{name}");
                let back: Vec<f64> = all.iter().map(|row| row[v]).collect();
                assert_close(row, &back, promises.rounding, slack, name);
                for (w, there) in row.iter().enumerate() {
                    for (x, beyond) in all[w].iter().enumerate() {
                        let detour = (there + beyond) * (1.0 + promises.rounding) + slack;
                        assert!(row[x] <= detour, "{name}: {v} {w} {x}");
                    }
                }
            }
        }
    }
}

#[test]
fn distances_grow_no_faster_than_edges_and_lie_between_exact_ones_and_those_along_edges() {
    for surface in surfaces() {
        let [exact, along_edges] =
            [Method::Exact, Method::Dijkstra].map(|m| m.prepare(&surface, &()).unwrap());
        for (name, promises, solver) in solvers(&surface) {
            for source in [0, 50, 111].map(VertexId) {
                let found = solver.distances(source).unwrap();
                if promises.is_lipschitz {
                    for (ends, length) in surface.topology().edges().iter().zip(surface.edge_lengths()) {
                        let [a, b] = ends.map(|v| found[v.index()]);
                        assert!((a - b).abs() <= length * (1.0 + 1e-12) + 1e-13 * a, "{name}: {a} {b}");
                    }
                    // Growth along edges bounds distances by those along edges.
                    let bounds = along_edges.distances(source).unwrap();
                    assert!(found.iter().zip(bounds).all(|(d, b)| *d <= b * (1.0 + 1e-12)), "{name}");
                }
                if promises.is_upper_bound {
                    let bounds = exact.distances(source).unwrap();
                    assert!(found.iter().zip(bounds).all(|(d, b)| *d >= b * (1.0 - 1e-12)), "{name}");
                }
            }
        }
    }
}

#[test]
fn the_nearest_of_several_sources_counts() {
    for surface in surfaces() {
        for (name, promises, solver) in solvers(&surface) {
            let sources = [3, 77, 140];
            let single = sources.map(|source| solver.distances(VertexId(source)).unwrap());
            let nearest: Vec<f64> = (0..surface.n_vertices())
                .map(|v| single.iter().map(|row| row[v]).fold(f64::INFINITY, f64::min))
                .collect();
            let slack = promises.slack * longest_edge(&surface);
            let found = solve(solver.as_ref(), &sources, f64::INFINITY);
            assert!(sources.iter().all(|s| found[*s as usize] == 0.0), "{name}");
            assert_close(&found, &nearest, promises.rounding, slack, name);
            let twice = solve(solver.as_ref(), &[77, 77], f64::INFINITY);
            assert_close(&twice, &single[1], promises.rounding, 0.0, name);
            let none = solve(solver.as_ref(), &[], f64::INFINITY);
            assert!(none.iter().all(|d| *d == f64::INFINITY), "{name}");
        }
    }
}

#[test]
fn distances_beyond_a_limit_are_infinite_and_those_below_it_stay() {
    for surface in surfaces() {
        for (name, promises, solver) in solvers(&surface) {
            let full = solver.distances(VertexId(50)).unwrap();
            for limit in [0.0, 0.7, 2.0, 5.5, 1e3, full[20]] {
                let found = solve(solver.as_ref(), &[50], limit);
                for (found, full) in found.iter().zip(&full) {
                    assert!(*found >= *full && (*found <= limit || *found == f64::INFINITY), "{name}");
                    if promises.has_exact_limit {
                        assert_eq!(*found, if *full <= limit { *full } else { f64::INFINITY }, "{name}");
                    }
                }
            }
            // Runs that end early leave nothing behind.
            assert_eq!(solver.distances(VertexId(50)).unwrap(), full, "{name}");
        }
    }
}

#[test]
fn distances_are_infinite_exactly_on_unconnected_components() {
    let parts = [shapes::icosphere(2), shapes::grid(6, 5, 1.0), shapes::torus(8, 6, 2.0, 0.5)];
    let whole = shapes::disjoint(&parts).intrinsic();
    let link = Link { ends: [5, 165].map(VertexId), length: 2.0 };
    let joined = whole.clone().with_links(vec![link]);
    let starts = [0, 162, 192, 240];
    for (surface, ends) in [(whole, [162, 192, 240]), (joined, [192, 192, 240])] {
        for (name, _, solver) in solvers(&surface) {
            for (part, end) in ends.into_iter().enumerate() {
                let start = if end == ends[0] { 0 } else { starts[part] };
                let found = solver.distances(VertexId::from(starts[part] + 1)).unwrap();
                for (v, d) in found.iter().enumerate() {
                    assert_eq!(d.is_finite(), (start..end).contains(&v), "{name}, vertex {v}");
                }
            }
        }
    }
}

#[test]
fn folding_a_sheet_changes_no_distance() {
    let sheet = shapes::grid(9, 7, 0.3);
    let flat = solvers(&sheet.intrinsic());
    let folded = solvers(&shapes::fold(&sheet, 4.0 * 0.3, 2.9).intrinsic());
    for ((name, .., flat), (.., folded)) in flat.into_iter().zip(folded) {
        for source in [0, 17, 40].map(VertexId) {
            let [found, expected] = [&folded, &flat].map(|solver| solver.distances(source).unwrap());
            assert_close(&found, &expected, 1e-9, 0.0, name);
        }
    }
}

#[test]
fn the_numbering_of_vertices_and_faces_and_the_orientation_of_faces_do_not_matter() {
    let mesh = hills(5);
    let n = mesh.n_vertices();
    let renamed = |v: VertexId| VertexId::from(v.index() * 101 % n);
    let mut faces: Vec<_> = mesh.topology().faces().iter().rev().map(|face| face.map(renamed)).collect();
    for (i, face) in faces.iter_mut().enumerate() {
        face.rotate_left(i % 3);
        if i % 5 == 0 {
            face.swap(0, 1);
        }
    }
    let mut names = vec![VertexId(0); n];
    (0..n).map(VertexId::from).for_each(|v| names[renamed(v).index()] = v);
    let length = |ends: [VertexId; 2]| {
        let [a, b] = ends.map(|v| names[v.index()]);
        mesh.length(mesh.topology().edge_between(a, b).unwrap())
    };
    let other = IntrinsicMesh::with_lengths(Topology::new(n, faces), length);
    let both = solvers(&mesh).into_iter().zip(solvers(&other));
    for ((name, promises, one), (.., other)) in both {
        for source in [0, 40, 77].map(VertexId) {
            let found = other.distances(renamed(source)).unwrap();
            let found: Vec<f64> = (0..n).map(|v| found[renamed(VertexId::from(v)).index()]).collect();
            assert_close(&found, &one.distances(source).unwrap(), promises.rounding, 0.0, name);
        }
    }
}

#[test]
fn columns_are_the_distances_from_single_sources_for_any_number_of_threads() {
    for (name, _, solver) in solvers(&hills(9)) {
        for count in [0, 1, 4, 23] {
            let sources: Vec<VertexId> = (0..count).map(|i| VertexId(i * 6)).collect();
            let single: Vec<f64> =
                sources.iter().flat_map(|source| solver.distances(*source).unwrap()).collect();
            for threads in [1, 4] {
                let columns = testkit::on_threads(threads, || solver.distance_columns(&sources).unwrap());
                assert_eq!(columns.as_slice(), single, "{name}");
            }
        }
    }
}

#[test]
fn surfaces_without_faces_or_vertices_are_handled() {
    let empty = IntrinsicMesh::new(Topology::new(0, Vec::new()), Vec::new());
    for (name, _, solver) in solvers(&empty) {
        assert_eq!((solver.n_vertices(), solve(solver.as_ref(), &[], f64::INFINITY)), (0, vec![]), "{name}");
        assert_eq!(solver.distance_columns(&[]).unwrap().shape(), (0, 0), "{name}");
    }
    let points = IntrinsicMesh::new(Topology::new(2, Vec::new()), Vec::new());
    for (name, _, solver) in solvers(&points) {
        assert_eq!(solver.distances(VertexId(1)).unwrap(), [f64::INFINITY, 0.0], "{name}");
    }
}
