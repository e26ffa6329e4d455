//! Laws on random and degenerate meshes: non-manifold edges, boundaries, repeated and flipped faces, slivers, and
//! several components.

use base::Exceeded;
use mesh::{TriMesh, shapes};
use nalgebra::Point3;
use proptest::prelude::*;
use surface::{IntrinsicMesh, VertexId};

use super::every_method::solvers;
use super::longest_edge;
use crate::{Dijkstra, DistanceSolver, Exact};

/// Share of a distance that rounding may take or add.
pub(crate) const ROUNDING: f64 = 1e-11;

/// How far edge lengths leave the position of a vertex undetermined, in mesh units: rounding hides the height of flat
/// triangles, and the angles at edges much shorter than others.
pub(crate) fn left_open(surface: &IntrinsicMesh) -> f64 {
    let lengths = surface.edge_lengths().iter().copied().filter(|length| *length > 0.0);
    let shortest = lengths.fold(f64::INFINITY, f64::min);
    let longest = longest_edge(surface);
    longest * (64.0 * f64::EPSILON * longest / shortest).sqrt()
}

/// Triangles between points anywhere, slightly off the points of a lattice, or nearly in a plane.
pub(crate) fn soup() -> impl Strategy<Value = TriMesh> {
    let point = prop::array::uniform3(-1.0..1.0f64);
    let spread = prop_oneof![
        Just([0.0, 1.0, 1.0]),
        Just([0.0, 1.0, 1e-3]),
        Just([0.0, 1.0, 1e-9]),
        prop_oneof![Just(0.0), Just(1e-16), Just(1e-13), Just(1e-8), Just(1e-3)].prop_map(|s| [1.0, s, s]),
    ];
    let points = prop::collection::vec((0..27usize, point), 4..14);
    let faces = prop::collection::vec(prop::array::uniform3(0..1000usize), 1..40);
    (points, faces, spread).prop_map(|(points, faces, [lattice, xy, z])| {
        let at = |(place, [x, y, w]): &(usize, [f64; 3])| {
            let axis = |i: u32| lattice * (place / 3usize.pow(i) % 3) as f64;
            Point3::new(axis(0) + xy * x, axis(1) + xy * y, axis(2) + z * w)
        };
        let n = points.len();
        let faces = faces.iter().map(|f| f.map(|v| VertexId::from(v % n)));
        let faces = faces.filter(|[a, b, c]| a != b && b != c && c != a).collect();
        TriMesh { positions: points.iter().map(at).collect(), faces }
    })
}

/// A hilly sheet or a dented ball with faces reversed, repeated and removed, fins on edges that already have two
/// faces, and perhaps a second component.
pub(crate) fn tame() -> impl Strategy<Value = TriMesh> {
    let base = prop_oneof![
        (4..8usize, 4..8usize, 0u64..1000)
            .prop_map(|(nx, ny, seed)| shapes::jittered_grid(nx, ny, 1.0, 0.2, seed)),
        Just(shapes::icosphere(1)),
    ];
    let moves = prop::collection::vec(prop::array::uniform3(-1.0..1.0f64), 64);
    let choices = prop::collection::vec(0..40u8, 100);
    (base, moves, 0.0..0.3f64, choices, prop::bool::ANY).prop_map(|(base, moves, height, choices, twice)| {
        let mut mesh = base.clone();
        for (position, by) in mesh.positions.iter_mut().zip(moves.iter().cycle()) {
            let [x, y, z] = by.map(|b| height * b);
            *position += nalgebra::Vector3::new(0.3 * x, 0.3 * y, z);
        }
        let faces = std::mem::take(&mut mesh.faces);
        for ([a, b, c], choice) in faces.into_iter().zip(choices.iter().cycle()) {
            mesh.faces.extend(match choice {
                0..3 => vec![[b, a, c]],
                3 => vec![[a, b, c], [b, c, a]],
                4 => vec![],
                5 => {
                    let fin = VertexId::from(mesh.n_vertices());
                    let middle = nalgebra::center(&mesh.positions[a.index()], &mesh.positions[b.index()]);
                    mesh.positions.push(middle + nalgebra::Vector3::new(0.1, 0.2, 0.7));
                    vec![[a, b, c], [a, b, fin]]
                }
                _ => vec![[a, b, c]],
            });
        }
        if twice { shapes::disjoint(&[mesh, base]) } else { mesh }
    })
}

pub(crate) fn sources(mesh: &TriMesh) -> impl Iterator<Item = VertexId> {
    (0..mesh.n_vertices()).step_by(3).map(VertexId::from)
}

/// Distances from one source, or none where exact distances would need too many windows. That takes a closed tube of
/// faces with angles below 1e-6.
pub(crate) fn distances(
    solver: &dyn DistanceSolver,
    surface: &IntrinsicMesh,
    source: VertexId,
) -> Option<Vec<f64>> {
    match solver.distances(source) {
        Err(Exceeded::Steps { .. }) => {
            let thin = 1e-6 * longest_edge(surface);
            assert!(surface.edge_lengths().iter().any(|length| *length < thin), "no angle below 1e-6");
            None
        }
        found => Some(found.unwrap()),
    }
}

fn euclid(mesh: &TriMesh, a: VertexId, b: usize) -> f64 {
    (mesh.positions[a.index()] - mesh.positions[b]).norm()
}

/// Either, and whether it is tame.
fn with_kind() -> impl Strategy<Value = (TriMesh, bool)> {
    prop_oneof![(soup(), Just(false)), (tame(), Just(true))]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 128, failure_persistence: None, ..Default::default() })]

    #[test]
    fn every_method_keeps_its_promises((mesh, is_tame) in with_kind()) {
        let surface = mesh.intrinsic();
        let (longest, open) = (longest_edge(&surface), left_open(&surface));
        let (exact, dijkstra) = (Exact::new(&surface, &()), Dijkstra::new(&surface, &()));
        let solvers = solvers(&surface);
        for source in sources(&mesh) {
            let Some(exact) = distances(&exact, &surface, source) else { continue };
            let along_edges = dijkstra.distances(source).unwrap();
            for (v, e) in exact.iter().enumerate() {
                prop_assert!(*e >= euclid(&mesh, source, v) - open, "{e}");
            }
            for (name, promises, solver) in &solvers {
                let found = solver.distances(source).unwrap();
                prop_assert_eq!(found[source.index()], 0.0);
                for ((d, e), limit) in found.iter().zip(&exact).zip(&along_edges) {
                    prop_assert!(*d >= 0.0 && d.is_finite() == limit.is_finite(), "{name}: {d} {limit}");
                    if promises.is_upper_bound {
                        prop_assert!(*e <= d * (1.0 + ROUNDING), "{name}: {d} {e}");
                    }
                    // About one mesh in 6,000 has an error of more than one edge, behind fins and missing faces.
                    let above = if is_tame { 2.0 * longest } else { f64::INFINITY };
                    let is_close = *e <= d + longest && *d <= e + above;
                    prop_assert!(*name != "fast-marching" || is_close, "{d} {e}");
                }
                // Growth along edges bounds distances by those along edges.
                let edges = surface.topology().edges().iter().zip(surface.edge_lengths());
                for (ends, length) in edges.filter(|_| promises.is_lipschitz) {
                    let [a, b] = ends.map(|v| found[v.index()]);
                    let slack = ROUNDING * a.max(b).min(f64::MAX);
                    prop_assert!(a == b || (a - b).abs() <= length + slack, "{name}: {a} {b} over {length}");
                }
            }
        }
    }

    #[test]
    fn exact_distances_are_symmetric(mesh in prop_oneof![soup(), tame()]) {
        let surface = mesh.intrinsic();
        let (exact, open) = (Exact::new(&surface, &()), left_open(&surface));
        let all = (0..mesh.n_vertices()).map(|v| distances(&exact, &surface, VertexId::from(v)));
        let Some(all) = all.collect::<Option<Vec<_>>>() else { return Ok(()) };
        for (i, row) in all.iter().enumerate() {
            for (j, there) in row.iter().enumerate() {
                let back = all[j][i];
                prop_assert!(*there == back || (there - back).abs() <= 1e-9 * back + open, "{there} {back}");
            }
        }
    }
}
