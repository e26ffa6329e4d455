//! Surfaces for the tests, made from the analytic shapes of `mesh`.

use mesh::TriMesh;

use crate::{IntrinsicMesh, Topology, VertexId};

/// The intrinsic geometry of a mesh. `mesh` uses this crate as built without tests, so its types differ from these
/// and numbers are copied.
pub(crate) fn intrinsic(mesh: &TriMesh) -> IntrinsicMesh {
    let faces = mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0))).collect();
    let topology = Topology::new(mesh.n_vertices(), faces);
    let length = |[a, b]: &[VertexId; 2]| (mesh.positions[a.index()] - mesh.positions[b.index()]).norm();
    let lengths = topology.edges().iter().map(length).collect();
    IntrinsicMesh::new(topology, lengths)
}
