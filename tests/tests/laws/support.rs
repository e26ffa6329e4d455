//! Helpers of several modules.

use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use canonform::Surface;
use canonform::embed::{EmbedOptions, Embedded, FormOptions, StressChoice, StressOptions, embed};
use cargo_metadata::{Metadata, MetadataCommand};
use datasets::{ArticulatedOptions, Family, LabeledShape, articulated};
use geodesics::Method;
use linalg::DistanceMatrix;
use mesh::{RepairOptions, TriMesh};

/// The folder of the workspace.
pub(crate) fn workspace_root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The packages of the workspace.
pub(crate) fn metadata() -> Metadata {
    let mut command = MetadataCommand::new();
    command.manifest_path(workspace_root().join("Cargo.toml")).no_deps();
    command.other_options(["--offline".to_owned()]).exec().unwrap()
}

/// All files below a folder with this extension, except what is built or downloaded.
pub(crate) fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let skipped = ["target", "node_modules", ".venv", ".pytest_cache"];
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let files = entries.flat_map(|path| match path.is_dir() {
        true if skipped.iter().any(|name| path.ends_with(name)) => Vec::new(),
        true => files(&path, extension),
        false => vec![path],
    });
    files.filter(|path| path.extension().is_some_and(|found| found == extension)).collect()
}

/// The built-in dataset with 1,000 vertices a shape.
pub(crate) static SHAPES: LazyLock<Vec<LabeledShape>> = LazyLock::new(|| {
    articulated(&ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() }).unwrap()
});

/// A shape of the built-in dataset with 1,000 vertices: a body with limbs, without symmetries.
pub(crate) fn body(family: Family) -> TriMesh {
    pose(family, 1)
}

/// The same in another pose.
pub(crate) fn pose(family: Family, pose: usize) -> TriMesh {
    let name = format!("{}{pose}", family.name());
    SHAPES.iter().find(|shape| shape.name == name).unwrap().mesh.clone()
}

/// The surface of a clean mesh.
pub(crate) fn surface(mesh: &TriMesh) -> Surface {
    Surface::new(mesh, &RepairOptions::default(), &()).unwrap()
}

/// An embedding with its stress.
pub(crate) fn measured(surface: &Surface, options: &FormOptions, choice: StressChoice) -> Embedded {
    let stress = StressOptions { choice, seed: options.seed, ..StressOptions::default() };
    embed(surface, EmbedOptions::from(options).stress(stress), &()).unwrap()
}

/// All distances by the default method.
pub(crate) fn all_pairs(surface: &Surface) -> DistanceMatrix {
    Method::default().prepare(surface.intrinsic(), &()).unwrap().distance_matrix().unwrap()
}

/// Coordinates, eigenvalues, samples and stress, with all their digits.
pub(crate) fn facts(result: &Embedded) -> String {
    let stress = result.report.stress.as_ref().map(|stress| (stress.value, stress.interval));
    format!("{:?} {:?} {stress:?}", result.embedding, result.report.samples)
}

/// The largest difference between two lists, relative to the largest magnitude in the second.
pub(crate) fn gap(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let largest = b.iter().fold(0.0f64, |most, x| most.max(x.abs()));
    a.iter().zip(b).fold(0.0f64, |most, (x, y)| most.max((x - y).abs())) / largest
}
