//! What kind of match two meshes are: one file, one geometry, one surface, one shape, one class, or a part of each other.
//!
//! ```text
//! TriMesh -> MeshGeometry -> same vertices? components? one surface in space? -> MatchEvidence -> words
//! ```

mod exact;
mod geometry;
mod in_space;
mod kinds;
mod match_evidence;
mod mesh_change;
mod parts;
mod same_surface;
mod triangles;
mod units;
mod words;

pub use geometry::MeshGeometry;
pub use in_space::SurfaceGap;
pub use kinds::{Basis, Change, EvidenceKind};
pub use match_evidence::MatchEvidence;
pub use parts::{Parts, Side};
pub use units::UnitChange;
