//! Triangle meshes: reading and writing, validation and repair, connectivity, intrinsic geometry.
//!
//! file -> [`io`] -> [`TriMesh`] -> [`repair()`] -> [`IntrinsicMesh`] -> `geodesics`
//!
//! Knows nothing of distances, embeddings or matrices.

mod ids;
mod intrinsic;
mod topology;
mod tri_mesh;

pub use ids::{CornerId, EdgeId, FaceId, VertexId};
pub use intrinsic::{IntrinsicMesh, Link};
pub use topology::Topology;
pub use tri_mesh::TriMesh;
