//! Vertices and edges of very many faces: right distances, at a cost near linear in the degree.

use std::f64::consts::TAU;
use std::time::Duration;

use base::Budget;
use surface::{IntrinsicMesh, VertexId};

use super::{all_triangles, methods, spatial};
use crate::{DistanceSolver, Exact, FastMarchingOptions, Method, Update};

fn rim(n: u32, height: f64) -> impl Iterator<Item = [f64; 3]> {
    (0..n).map(move |i| f64::from(i) / f64::from(n) * TAU).map(move |t| [t.cos(), t.sin(), height])
}

/// A flat regular polygon, split from its first corner.
fn polygon(n: u32) -> IntrinsicMesh {
    spatial(&rim(n, 0.0).collect::<Vec<_>>(), &(2..n).map(|i| [0, i - 1, i]).collect::<Vec<_>>())
}

/// A cone around vertex 0.
fn cone(n: u32) -> IntrinsicMesh {
    let points: Vec<_> = std::iter::once([0.0; 3]).chain(rim(n, -0.3)).collect();
    spatial(&points, &(0..n).map(|i| [0, i + 1, (i + 1) % n + 1]).collect::<Vec<_>>())
}

/// Faces that have one edge in common.
fn book(n: u32) -> IntrinsicMesh {
    let points: Vec<_> = [[0.0; 3], [0.0, 0.0, 1.0]].into_iter().chain(rim(n, 0.4)).collect();
    spatial(&points, &(0..n).map(|i| [0, 1, i + 2]).collect::<Vec<_>>())
}

/// Needles that have one vertex in common.
fn star(n: u32) -> IntrinsicMesh {
    let tips = rim(n, 0.2).flat_map(|[x, y, z]| [[x, y, z], [x, y, z + 1e-3]]);
    let points: Vec<_> = std::iter::once([0.0; 3]).chain(tips).collect();
    spatial(&points, &(0..n).map(|i| [0, 2 * i + 1, 2 * i + 2]).collect::<Vec<_>>())
}

/// The largest error relative to the largest exact distance that a method may make at hubs.
fn tolerance(method: Method) -> f64 {
    match method {
        Method::Exact => 0.0,
        Method::FastMarching(FastMarchingOptions { update: Update::Planar, .. }) => 0.1,
        Method::FastMarching(_) => 0.05,
        // Only a few of the triangles around a source carry the direction of the heat.
        Method::Heat(_) => 0.5,
        // Along the rim of a polygon instead of across it.
        Method::Dijkstra => 0.6,
        Method::BreadthFirst => f64::INFINITY,
    }
}

#[test]
fn distances_at_hubs_are_those_of_the_exact_solver() {
    let hubs = [
        ("polygon", polygon(600)),
        ("cone", cone(600)),
        ("book", book(300)),
        ("star", star(300)),
        ("triangles", all_triangles(9)),
    ];
    for (name, hub) in hubs {
        for source in [0, 1, 5].map(VertexId) {
            let exact = Exact::new(&hub, &()).distances(source).unwrap();
            let largest = exact.iter().copied().fold(0.0, f64::max);
            for (_, method) in methods() {
                let found = method.prepare(&hub, &()).unwrap().distances(source).unwrap();
                let error = found.iter().zip(&exact).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max);
                let error = error / largest;
                assert!(error <= tolerance(method), "{name}, {} from {source}: {error}", method.name());
                assert!(found.iter().all(|d| d.is_finite() && *d >= 0.0));
            }
        }
    }
}

/// Far more than any method needs, and far less than one of quadratic cost does.
const GENEROUS: Duration = Duration::from_secs(60);

#[test]
#[ignore = "slow: make test-all"]
fn no_method_is_quadratic_in_the_degree() {
    let n = 200_000;
    for (name, hub) in [("polygon", polygon(n)), ("cone", cone(n)), ("book", book(n)), ("star", star(n))] {
        for (_, method) in methods() {
            // Its windows grow with the square of the number of faces at an edge.
            if (name, method) == ("book", Method::Exact) {
                continue;
            }
            let budget = Budget::unlimited().with_time(GENEROUS);
            let solver = method.prepare(&hub, &budget);
            let found = solver.and_then(|solver| Ok(solver.distances(VertexId(5))?));
            assert!(found.is_ok(), "{name}, {}: {found:?}", method.name());
        }
    }
}

#[test]
fn surfaces_that_touch_in_a_vertex_are_crossed_there() {
    // Two tetrahedra with a common vertex: its faces form two closed fans, and no edge is free.
    let points = [[0.0; 3], [1.0, 0.0, 1.0], [-1.0, 1.0, 1.2], [-1.0, -1.0, 0.9]];
    let below = points[1..].iter().map(|[x, y, z]| [*x, *y, -*z]);
    let faces = |[a, b, c]: [u32; 3]| [[0, a, b], [0, b, c], [0, c, a], [a, b, c]];
    let surface = spatial(
        &points.into_iter().chain(below).collect::<Vec<_>>(),
        &[faces([1, 2, 3]), faces([4, 5, 6])].concat(),
    );
    for method in Method::all().into_iter().filter(|method| !matches!(method, Method::Heat(_))) {
        let solver = method.prepare(&surface, &()).unwrap();
        let [from_tip, from_rim] = [0, 3].map(|v| solver.distances(VertexId(v)).unwrap());
        for below in 4..7 {
            let expected = from_rim[0] + from_tip[below];
            assert!((from_rim[below] / expected - 1.0).abs() < 1e-12, "{}", method.name());
        }
    }
}
