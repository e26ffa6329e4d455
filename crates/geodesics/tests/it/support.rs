//! Surfaces and methods that several laws are about.

use canonform_geodesics::{FastMarchingOptions, Method, Update};
use surface::{IntrinsicMesh, Topology, VertexId};

/// Every method with its default options, and fast marching with the planar update.
pub(crate) fn methods() -> Vec<(&'static str, Method)> {
    let planar = FastMarchingOptions { update: Update::Planar, ..Default::default() };
    let named = Method::all().map(|method| (method.name(), method));
    named.into_iter().chain([("planar", Method::FastMarching(planar))]).collect()
}

/// A surface of faces between points in space.
pub(crate) fn surface(points: &[[f64; 3]], faces: Vec<[usize; 3]>) -> IntrinsicMesh {
    let topology = Topology::new(points.len(), faces.into_iter().map(|f| f.map(VertexId::from)).collect());
    let length = |ends: &[VertexId; 2]| {
        let [p, q] = ends.map(|v| points[v.index()]);
        (0..3).map(|i| (p[i] - q[i]).powi(2)).sum::<f64>().sqrt()
    };
    let lengths = topology.edges().iter().map(length).collect();
    IntrinsicMesh::new(topology, lengths)
}

/// All triangles between `n` points.
pub(crate) fn all_triangles(n: usize) -> IntrinsicMesh {
    let faces = (0..n).flat_map(|a| (a + 1..n).flat_map(move |b| (b + 1..n).map(move |c| [a, b, c])));
    let at = |t: f64| [(0.7 * t).sin() + 0.05 * t, (1.3 * t).cos(), (2.1 * t + 0.5).sin()];
    surface(&(0..n).map(|i| at(i as f64)).collect::<Vec<_>>(), faces.collect())
}

pub(crate) fn longest_edge(surface: &IntrinsicMesh) -> f64 {
    surface.edge_lengths().iter().copied().fold(0.0, f64::max)
}
