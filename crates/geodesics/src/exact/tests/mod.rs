//! Laws of exact distances.

mod closed_forms;
mod log_map;
mod oracle;

use surface::{IntrinsicMesh, VertexId};

use super::Exact;
use crate::DistanceSolver;
use crate::tests::{assert_close, bumpy, faces, points, spatial};

/// The matrix of all distances, one row a source.
fn all_pairs(mesh: &IntrinsicMesh) -> Vec<Vec<f64>> {
    let exact = Exact::new(mesh, &());
    (0..mesh.n_vertices()).map(|v| exact.distances(VertexId::from(v)).unwrap()).collect()
}
