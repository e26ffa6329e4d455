//! Laws of the crate, through what it exports, and surfaces and references for the tests of several modules.

mod budgets;
mod every_method;
mod hubs;
mod properties;
mod slivers;

use std::path::Path;

use mesh::{TriMesh, shapes};
use proptest::prelude::*;
use surface::{IntrinsicMesh, Topology, VertexId};

use crate::{FastMarchingOptions, Method, Update};

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
fn all_triangles(n: u32) -> IntrinsicMesh {
    let faces = (0..n).flat_map(|a| (a + 1..n).flat_map(move |b| (b + 1..n).map(move |c| [a, b, c])));
    let at = |t: f64| [(0.7 * t).sin() + 0.05 * t, (1.3 * t).cos(), (2.1 * t + 0.5).sin()];
    let points: Vec<_> = (0..n).map(|i| at(f64::from(i))).collect();
    spatial(&points, &faces.collect::<Vec<_>>())
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

/// Lengths that violate the triangle inequality as a rule.
pub(crate) fn lengths_of_nothing() -> impl Strategy<Value = f64> {
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
pub(crate) fn impossible() -> impl Strategy<Value = IntrinsicMesh> {
    let raw = prop::collection::vec((0..9u32, 1..9u32, 0..9u32), 1..30);
    (raw, prop::collection::vec(lengths_of_nothing(), 40)).prop_map(|(raw, lengths)| {
        let faces = raw.iter().map(|(a, b, c)| [*a, (a + b) % 9, *c]).filter(|[a, b, c]| a != c && b != c);
        let topology = Topology::new(9, faces.map(|f| f.map(VertexId)).collect());
        let lengths = lengths[..topology.n_edges()].to_vec();
        IntrinsicMesh::new(topology, lengths)
    })
}

/// A sheet over points of a 3 x 3 x 3 lattice, hardly moved: collinear, coplanar, coincident.
pub(crate) fn pinched(nx: usize, ny: usize) -> impl Strategy<Value = IntrinsicMesh> {
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

#[track_caller]
pub(crate) fn assert_close(found: f64, expected: f64, relative: f64) {
    let tolerance = relative * expected.abs();
    assert!(
        (found - expected).abs() <= tolerance || found == expected,
        "{found} instead of {expected}, off by {:e}",
        (found - expected) / expected
    );
}

/// Exact distances on a real mesh, by the algorithm of Mitchell, Mount and Papadimitriou.
pub(crate) struct Reference {
    /// The mesh without repairs, as for the references.
    pub(crate) mesh: TriMesh,
    /// Sources, and the distances from each to all vertices.
    pub(crate) rows: Vec<(VertexId, Vec<f64>)>,
}

/// The reference for a mesh such as `tosca-lowres/cat0.vert`.
pub(crate) fn reference(data: &Path, mesh: &str) -> Reference {
    let name = Path::new(mesh).file_stem().unwrap().to_string_lossy().into_owned();
    let file = |what| data.join(format!("exact/{name}-{what}.npy"));
    let mesh = mesh_io::read(&data.join(mesh)).unwrap();
    let sources = testkit::array(&file("sources")).1.into_iter().map(VertexId);
    let (_, distances) = testkit::array::<f64>(&file("distances"));
    let rows = distances.chunks_exact(mesh.n_vertices()).map(<[f64]>::to_vec);
    Reference { rows: sources.zip(rows).collect(), mesh }
}
