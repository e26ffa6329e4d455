//! A surface as its inhabitants know it: connectivity and edge lengths, no coordinates.
//!
//! `mesh::TriMesh` -> [`IntrinsicMesh`] -> `geodesics`, `descriptors`
//!
//! * [`Topology`] is the connectivity of triangles, whatever is wrong with them: an edge lists the corners
//!   that face it, so edges with three faces and faces of opposite orientation are ordinary.
//! * [`IntrinsicMesh`] adds one length an edge. Whatever is computed from it cannot change under bending.
//! * [`laplacian`] has the stiffness and masses of functions on a surface of any kind.
//! * [`Components`] and [`DisjointSets`] tell its pieces.

mod components;
mod disjoint_sets;
mod ids;
mod intrinsic;
pub mod laplacian;
mod one_ring;
mod rows;
#[cfg(test)]
mod testing;
mod topology;
mod triangle;
mod triangulation;

pub use components::{Components, components, components_of_faces, components_with_links};
pub use disjoint_sets::DisjointSets;
pub use ids::{CornerId, EdgeId, FaceId, VertexId};
pub use intrinsic::{IntrinsicMesh, Link};
pub use one_ring::{CornerTable, Fan, FanCorner, OneRing, VertexKind, Winding, total_angle};
pub use rows::Rows;
pub use topology::Topology;
pub use triangle::{Triangle, double_area, scalar_product};
pub use triangulation::{GluedTriangle, Loops, Triangulation};
