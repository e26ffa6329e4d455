//! Laws of all distance solvers, through the trait: a new method needs one line in [`promises`].

use base::Exceeded;
use mesh::shapes;
use surface::{EdgeId, FaceId, IntrinsicMesh, Link, SurfacePoint, Topology, VertexId};

use super::{bumpy, distances_from, longest_edge, methods};
use crate::{DistanceSolver, Method, Source};

/// What a method promises beyond what all do.
pub(super) struct Promises {
    /// By how much distances may deviate from those of a metric, in lengths of the longest edge.
    slack: f64,
    /// Share of a distance that rounding may take or add.
    rounding: f64,
    /// Whether no distance grows faster than along an edge.
    pub(super) is_lipschitz: bool,
    /// Whether no distance is below the exact one.
    pub(super) is_upper_bound: bool,
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
pub(super) fn solvers(surface: &IntrinsicMesh) -> Vec<(&'static str, Promises, Box<dyn DistanceSolver>)> {
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
fn the_nearest_of_several_sources_counts() {
    let sources = [
        SurfacePoint::Vertex(VertexId(3)),
        SurfacePoint::Vertex(VertexId(77)),
        SurfacePoint::Edge { edge: EdgeId(150), t: 0.3 },
        SurfacePoint::Face { face: FaceId(200), barycentric: [0.2, 0.7, 0.1] },
    ];
    for surface in surfaces() {
        let sources = sources.map(|point| Source::new(&surface, point).unwrap());
        for (name, promises, solver) in solvers(&surface) {
            let solve = |sources: &[Source]| distances_from(solver.as_ref(), sources, f64::INFINITY);
            let single = sources.each_ref().map(|source| solve(std::slice::from_ref(source)));
            let nearest: Vec<f64> = (0..surface.n_vertices())
                .map(|v| single.iter().map(|row| row[v]).fold(f64::INFINITY, f64::min))
                .collect();
            let slack = promises.slack * longest_edge(&surface);
            let found = solve(&sources);
            assert_eq!([3, 77].map(|v: usize| found[v]), [0.0; 2], "{name}");
            assert_close(&found, &nearest, promises.rounding, slack, name);
            let twice = solve(&[&sources[1..2], &sources[1..2]].concat());
            assert_close(&twice, &single[1], promises.rounding, 0.0, name);
            assert!(solve(&[]).iter().all(|d| *d == f64::INFINITY), "{name}");
        }
    }
}

#[test]
fn distances_from_points_of_edges_and_faces_are_straight_in_the_plane() {
    let sheet = shapes::jittered_grid(31, 31, 1.0, 0.2, 2);
    let surface = sheet.intrinsic();
    let (topology, at) = (surface.topology(), |v: VertexId| sheet.positions[v.index()].coords);
    let mut sources = Vec::new();
    for face in [0, 900].map(FaceId) {
        let [a, b, c] = topology.faces()[face.index()].map(at);
        for barycentric @ [s, t, u] in [
            [0.2, 0.5, 0.3],
            [1.0, 0.0, 0.0],
            [0.0, 0.4, 0.6],
            [0.5, 0.5, 0.0],
            [1e-13, 0.3, 0.7 - 1e-13],
            [1e-7, 1.0 - 2e-7, 1e-7],
            [1.0 - 2e-10, 1e-10, 1e-10],
        ] {
            sources.push((SurfacePoint::Face { face, barycentric }, a * s + b * t + c * u));
        }
    }
    for edge in [0, 700, 1500].map(EdgeId) {
        let [a, b] = topology.edges()[edge.index()].map(at);
        let point = |t| (SurfacePoint::Edge { edge, t }, a + (b - a) * t);
        sources.extend([0.0, 0.25, 0.9, 1.0, 1e-14].map(point));
    }
    // The largest error, as a share of the largest distance, and the mean one, as a share of each.
    let methods = [
        (Method::default(), [1e-9, 1e-6]),
        (Method::Exact, [1e-11, 1e-9]),
        (Method::Heat(Default::default()), [f64::INFINITY, 0.03]),
    ];
    for (method, limits) in methods {
        let solver = method.prepare(&surface, &()).unwrap();
        for (point, from) in &sources {
            let source = Source::new(&surface, *point).unwrap();
            let found = distances_from(solver.as_ref(), &[source], f64::INFINITY);
            let (mut worst, mut sum, mut largest) = (0.0f64, 0.0, 0.0f64);
            for (found, p) in found.iter().zip(&sheet.positions) {
                let straight = (p.coords - from).norm();
                let error = (found - straight).abs();
                (worst, largest) = (worst.max(error), largest.max(straight));
                sum += error / straight.max(0.1);
            }
            let errors = [worst / largest, sum / found.len() as f64];
            let is_close = errors[0] < limits[0] && errors[1] < limits[1];
            assert!(is_close, "{} from {point}: {errors:?}", method.name());
        }
    }
}

#[test]
fn distances_beyond_a_limit_are_infinite_and_those_below_it_stay() {
    for surface in surfaces() {
        for (name, promises, solver) in solvers(&surface) {
            let full = solver.distances(VertexId(50)).unwrap();
            for limit in [0.0, 0.7, 2.0, 5.5, 1e3, full[20]] {
                let found = distances_from(solver.as_ref(), &[Source::vertex(VertexId(50))], limit);
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
            // Fronts start again behind the link.
            if ends[0] == 192 && (name == "fast-marching" || name == "exact") {
                let [near, behind] = [1, 165].map(|v| solver.distances(VertexId(v)).unwrap());
                let expected: Vec<f64> = behind[162..192].iter().map(|d| near[5] + 2.0 + d).collect();
                assert_close(&near[162..192], &expected, 1e-12, 0.0, name);
            }
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
        assert!(distances_from(solver.as_ref(), &[], f64::INFINITY).is_empty(), "{name}");
        assert_eq!(solver.distance_columns(&[]).unwrap().shape(), (0, 0), "{name}");
    }
    let points = IntrinsicMesh::new(Topology::new(2, Vec::new()), Vec::new());
    for (name, _, solver) in solvers(&points) {
        assert_eq!(solver.distances(VertexId(1)).unwrap(), [f64::INFINITY, 0.0], "{name}");
    }
}

/// Pseudo-random numbers in [0, 1).
fn noise(i: usize) -> f64 {
    (i as f64 * 0.618_033_988_749_894_9 + (i * i) as f64 * 0.414_213_562_373_095).fract()
}

#[test]
fn lengths_of_no_surface_give_distances_where_edges_lead() {
    let topology = || Topology::new(36, shapes::grid(6, 6, 1.0).faces);
    let n_edges = topology().n_edges();
    type Length = fn(usize) -> f64;
    let lengths: [(&str, Length); 7] = [
        ("points", |_| 0.0),
        ("random", noise),
        ("random over many scales", |i| 10f64.powf(40.0 * noise(i) - 20.0)),
        ("half of them zero", |i| if noise(i) < 0.5 { 0.0 } else { 1.0 }),
        ("one huge", |i| if i == 20 { 1e300 } else { 1.0 }),
        ("huge", |_| 1e306),
        ("tiny", |_| 5e-324),
    ];
    for (what, length) in lengths {
        let surface = IntrinsicMesh::new(topology(), (0..n_edges).map(length).collect());
        for (name, _, solver) in solvers(&surface) {
            for source in [0, 18, 35].map(VertexId) {
                let found = match solver.distances(source) {
                    // They may need any number of windows.
                    Err(Exceeded::Steps { .. }) => continue,
                    found => found.unwrap(),
                };
                assert_eq!(found[source.index()], 0.0, "{name}, {what}");
                assert!(found.iter().all(|d| *d >= 0.0 && d.is_finite()), "{name}, {what}: {found:?}");
            }
        }
    }
}
