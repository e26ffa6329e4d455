//! Intrinsic geometry of triangle meshes: connectivity and edge lengths, no coordinates.
//!
//! `mesh::TriMesh` -> [`IntrinsicMesh`] -> `geodesics`, `descriptors`
//!
//! * [`Topology`] is a corner table whose edges may have any number of faces of any orientation.
//! * [`IntrinsicMesh`] adds one length per edge. No result computed from it changes when the surface is bent.
//! * [`OneRing`] has the faces around a vertex in order, and tells whether shortest paths may bend there.
//! * [`Triangulation`] flips edges inside the surface until it is Delaunay.
//! * [`laplacian`] has the stiffness and mass matrices of any surface.
//! * [`EdgeGraph`] finds shortest paths along edges.
//! * [`short_loops`] finds narrow handles and tunnels.
//! * [`Components`] are the connected components, found with [`DisjointSets`].

mod components;
mod disjoint_sets;
mod edge_graph;
mod frontier;
mod ids;
mod intrinsic;
pub mod laplacian;
mod loops;
mod nearest_first;
mod one_ring;
mod point;
mod rows;
#[cfg(test)]
mod testing;
mod topology;
mod triangle;
mod triangulation;

pub use components::{Components, components_of_faces, components_with_links};
pub use disjoint_sets::DisjointSets;
pub use edge_graph::{EdgeGraph, Way};
pub use frontier::Frontier;
pub use ids::{CornerId, EdgeId, FaceId, VertexId};
pub use intrinsic::{IntrinsicMesh, Link, power_of_two_below, unit_for};
pub use loops::{SurfaceLoop, short_loops};
pub use nearest_first::NearestFirst;
pub use one_ring::{Fan, FanCorner, OneRing, VertexKind, Winding};
pub use point::SurfacePoint;
pub use rows::Rows;
pub use topology::Topology;
pub use triangle::{Triangle, scalar_product, twice_area};
pub use triangulation::{GluedTriangle, Loops, Triangulation};
