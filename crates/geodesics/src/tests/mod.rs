//! Laws of the crate, through what it exports, and surfaces and references for the tests of several modules.

mod budgets;
mod every_method;
mod hubs;
pub(crate) mod properties;
mod reference;
mod slivers;

use mesh::{TriMesh, shapes};
use surface::{IntrinsicMesh, Topology, VertexId};

use crate::{DistanceSolver, FastMarchingOptions, Method, Source, Update};

/// Connectivity and lengths of a mesh in space.
pub(crate) fn spatial(points: &[[f64; 3]], faces: &[[u32; 3]]) -> IntrinsicMesh {
    let topology = Topology::new(points.len(), faces.iter().map(|f| f.map(VertexId)).collect());
    let length = |ends: [VertexId; 2]| {
        let [p, q] = ends.map(|v| points[v.index()]);
        (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
    };
    IntrinsicMesh::with_lengths(topology, length)
}

/// All triangles between `n` points.
pub(crate) fn all_triangles(n: u32) -> IntrinsicMesh {
    let faces = (0..n).flat_map(|a| (a + 1..n).flat_map(move |b| (b + 1..n).map(move |c| [a, b, c])));
    let at = |t: f64| [(0.7 * t).sin() + 0.05 * t, (1.3 * t).cos(), (2.1 * t + 0.5).sin()];
    let points: Vec<_> = (0..n).map(|i| at(f64::from(i))).collect();
    spatial(&points, &faces.collect::<Vec<_>>())
}

/// The distance of every vertex from the nearest source; infinite beyond a limit.
pub(crate) fn distances_from(solver: &dyn DistanceSolver, sources: &[Source], max_distance: f64) -> Vec<f64> {
    let mut out = vec![0.0; solver.n_vertices()];
    solver.solve_into(sources, max_distance, &mut out).unwrap();
    out
}

fn longest_edge(surface: &IntrinsicMesh) -> f64 {
    surface.edge_lengths().iter().copied().fold(0.0, f64::max)
}

/// Every method with its default options, and fast marching with the planar update.
fn methods() -> Vec<(&'static str, Method)> {
    let planar = FastMarchingOptions { update: Update::Planar, ..Default::default() };
    let named = Method::all().map(|method| (method.name(), method));
    named.into_iter().chain([("planar", Method::FastMarching(planar))]).collect()
}

pub(crate) fn points(mesh: &TriMesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| [p.x, p.y, p.z]).collect()
}

pub(crate) fn faces(mesh: &TriMesh) -> Vec<[u32; 3]> {
    mesh.faces.iter().map(|f| f.map(|v| v.0)).collect()
}

/// A sheet in the plane, its inner vertices moved, raised by a random landscape of this height.
pub(crate) fn bumpy(n: usize, height: f64, seed: u64) -> IntrinsicMesh {
    let sheet = shapes::jittered_grid(n, n, 1.0, 0.24, seed);
    let noise = shapes::jittered_grid(n + 2, n + 2, 1.0, height, seed + 1);
    let mut at = points(&sheet);
    for (v, p) in at.iter_mut().enumerate() {
        let inner = (v / n + 1) * (n + 2) + v % n + 1;
        p[2] = noise.positions[inner].x - (v % n + 1) as f64;
    }
    spatial(&at, &faces(&sheet))
}

/// Distance of two points at these distances from the origin, at this angle.
pub(crate) fn apart(p: f64, q: f64, angle: f64) -> f64 {
    ((p - q).powi(2) + 4.0 * p * q * (0.5 * angle).sin().powi(2)).sqrt()
}

/// Flat rings of `n` sectors around vertex 0 with this total angle, closed or open, by their lengths alone, and the polar
/// coordinates of the vertices on the surface.
pub(crate) fn cone(n: usize, total: f64, n_rings: usize, is_closed: bool) -> (IntrinsicMesh, Vec<[f64; 2]>) {
    let spokes = if is_closed { n } else { n + 1 };
    let at = |ring: usize, sector: usize| VertexId::from(1 + ring * spokes + sector % spokes);
    let (mut faces, mut polar) = (Vec::new(), vec![[0.0; 2]]);
    for r in 0..n_rings {
        polar.extend((0..spokes).map(|s| [(r + 1) as f64, total * s as f64 / n as f64]));
        for s in 0..n {
            match r {
                0 => faces.push([VertexId(0), at(0, s), at(0, s + 1)]),
                _ => faces.extend([
                    [at(r - 1, s), at(r, s), at(r, s + 1)],
                    [at(r - 1, s), at(r, s + 1), at(r - 1, s + 1)],
                ]),
            }
        }
    }
    let length = |ends: [VertexId; 2]| {
        let [[p, a], [q, b]] = ends.map(|v| polar[v.index()]);
        let angle = if p * q == 0.0 { 0.0 } else { (a - b).abs() };
        apart(p, q, if is_closed { angle.min(total - angle) } else { angle })
    };
    (IntrinsicMesh::with_lengths(Topology::new(polar.len(), faces), length), polar)
}

#[track_caller]
pub(crate) fn assert_close(found: f64, expected: f64, relative: f64) {
    let tolerance = relative * expected.abs();
    assert!(
        (found - expected).abs() <= tolerance || found == expected,
        "{found} instead of {expected}, off by {:e}",
        (found - expected) / expected
    );
}
