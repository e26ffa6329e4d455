//! Helpers of several modules.

use std::path::{Path, PathBuf};

use canonform::Surface;
use canonform::compare::embedded_distances;
use canonform::embed::{EmbedOptions, Embedded, FormOptions, StressChoice, StressOptions, embed};
use cargo_metadata::{Metadata, MetadataCommand};
use datasets::{ArticulatedOptions, Family, articulated_shape};
use geodesics::Method;
use linalg::{DistanceMatrix, Matrix};
use mesh::{RepairOptions, TriMesh};
use nalgebra::Point3;
use surface::VertexId;

/// The folder of the workspace.
pub(crate) fn workspace_root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The folder of real meshes. Prints that the test is skipped if it does not exist.
pub(crate) fn data(test: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("CANONFORM_DATA")
        .map_or_else(|| workspace_root().join("../shared/data"), PathBuf::from);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: {test}: no folder {}; set CANONFORM_DATA", folder.display());
    None
}

/// The packages of the workspace.
pub(crate) fn metadata() -> Metadata {
    let mut command = MetadataCommand::new();
    command.manifest_path(workspace_root().join("Cargo.toml")).no_deps();
    command.other_options(["--offline".to_owned()]).exec().unwrap()
}

/// All Rust files below a folder.
pub(crate) fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| match path.is_dir() {
        true if path.ends_with("target") => Vec::new(),
        true => rust_files(&path),
        false => vec![path],
    });
    files.filter(|path| path.extension().is_some_and(|extension| extension == "rs")).collect()
}

/// A shape of the built-in dataset with 1,000 vertices: a body with limbs, without symmetries.
pub(crate) fn body(family: Family) -> TriMesh {
    let options = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    articulated_shape(family, 1, &options).unwrap().mesh
}

/// The surface of a clean mesh.
pub(crate) fn surface(mesh: &TriMesh) -> Surface {
    Surface::new(mesh, &RepairOptions::default(), &()).unwrap()
}

pub(crate) fn embedded(mesh: &TriMesh, options: &FormOptions) -> Embedded {
    embed(&surface(mesh), options, &()).unwrap()
}

pub(crate) fn measured(mesh: &TriMesh, options: &FormOptions, choice: StressChoice) -> Embedded {
    let stress = StressOptions { choice, ..StressOptions::default() };
    embed(&surface(mesh), EmbedOptions::from(options).stress(stress), &()).unwrap()
}

/// All distances between the embedded points of a mesh.
pub(crate) fn form_pairs(mesh: &TriMesh, options: &FormOptions) -> DistanceMatrix {
    embedded_distances(&embedded(mesh, options).embedding.coords).unwrap()
}

/// Fast marching with default options.
pub(crate) fn marching() -> Method {
    Method::default()
}

/// Distances from some vertices of a mesh, one column each.
pub(crate) fn columns(mesh: &TriMesh, method: Method, sources: &[VertexId]) -> Matrix {
    method.prepare(mesh.intrinsic(), &()).unwrap().distance_columns(sources).unwrap()
}

pub(crate) fn all_vertices(mesh: &TriMesh) -> Vec<VertexId> {
    (0..mesh.n_vertices()).map(VertexId::from).collect()
}

/// The largest difference between two lists, relative to the largest magnitude in the second.
pub(crate) fn gap(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    a.iter().zip(b).fold(0.0f64, |most, (x, y)| most.max((x - y).abs())) / largest
}

/// The mesh with every position moved.
pub(crate) fn moved(mesh: &TriMesh, motion: impl Fn(&Point3<f64>) -> Point3<f64>) -> TriMesh {
    TriMesh { positions: mesh.positions.iter().map(motion).collect(), faces: mesh.faces.clone() }
}

/// A fixed random permutation of `0..n`.
pub(crate) fn permutation(n: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..n).collect();
    let mut state = 12345u64;
    for i in (1..n).rev() {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        order.swap(i, (state >> 33) as usize % (i + 1));
    }
    order
}
