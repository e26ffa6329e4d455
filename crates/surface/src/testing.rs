//! Surfaces for the tests, made from the analytic shapes of `mesh`.

use mesh::TriMesh;

use crate::{IntrinsicMesh, Topology, VertexId};

/// The intrinsic geometry of a mesh. The types of `mesh` belong to this crate as it is built without its tests,
/// so numbers have to be carried over.
pub(crate) fn intrinsic(mesh: &TriMesh) -> IntrinsicMesh {
    let faces = mesh.faces.iter().map(|face| face.map(|v| VertexId(v.0))).collect();
    let topology = Topology::new(mesh.n_vertices(), faces);
    let length = |[a, b]: &[VertexId; 2]| (mesh.positions[a.index()] - mesh.positions[b.index()]).norm();
    let lengths = topology.edges().iter().map(length).collect();
    IntrinsicMesh::new(topology, lengths)
}
