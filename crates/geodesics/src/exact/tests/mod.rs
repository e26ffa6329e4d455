//! Laws of exact distances.

mod closed_forms;
mod degenerate;
mod laws;
mod oracle;
mod reference;

use mesh::{IntrinsicMesh, Topology, TriMesh, VertexId};

use super::Exact;
use crate::DistanceSolver;

/// Connectivity and lengths of a mesh in space.
fn spatial(points: &[[f64; 3]], faces: &[[u32; 3]]) -> IntrinsicMesh {
    let topology = Topology::new(points.len(), faces.iter().map(|f| f.map(VertexId)).collect());
    let length = |[a, b]: &[VertexId; 2]| {
        let (p, q) = (points[a.index()], points[b.index()]);
        ((p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2) + (p[2] - q[2]).powi(2)).sqrt()
    };
    let lengths = topology.edges().iter().map(length).collect();
    IntrinsicMesh::new(topology, lengths)
}

fn points(mesh: &TriMesh) -> Vec<[f64; 3]> {
    mesh.positions.iter().map(|p| [p.x, p.y, p.z]).collect()
}

fn faces(mesh: &TriMesh) -> Vec<[u32; 3]> {
    mesh.faces.iter().map(|f| f.map(|v| v.0)).collect()
}

/// A sheet in the plane, its inner vertices moved, raised by a random landscape of this height.
fn bumpy(n: usize, height: f64, seed: u64) -> IntrinsicMesh {
    let sheet = mesh::shapes::jittered_grid(n, n, 1.0, 0.24, seed);
    let noise = mesh::shapes::jittered_grid(n + 2, n + 2, 1.0, height, seed + 1);
    let mut at = points(&sheet);
    for (v, p) in at.iter_mut().enumerate() {
        let inner = (v / n + 1) * (n + 2) + v % n + 1;
        p[2] = noise.positions[inner].x - (v % n + 1) as f64;
    }
    spatial(&at, &faces(&sheet))
}

/// The matrix of all distances, one row a source.
fn all_pairs(mesh: &IntrinsicMesh) -> Vec<Vec<f64>> {
    let exact = Exact::new(mesh);
    (0..mesh.n_vertices()).map(|v| exact.distances(VertexId::from(v))).collect()
}

#[track_caller]
fn assert_close(found: f64, expected: f64, relative: f64) {
    let tolerance = relative * expected.abs();
    assert!(
        (found - expected).abs() <= tolerance || found == expected,
        "{found} instead of {expected}, off by {:e}",
        (found - expected) / expected
    );
}
