//! Triangle meshes: reading and writing, validation and repair, connectivity, intrinsic geometry.
//!
//! file -> [`io`] -> [`TriMesh`] -> [`repair()`] -> [`IntrinsicMesh`] -> `geodesics`
//!
//! * [`io`] reads and writes mesh files; whatever is in a file, it ends in a mesh or in a
//!   [`MeshError`] that names file, place, fault and remedy.
//! * [`validate`] reports all there is to know of a mesh and changes nothing.
//! * [`repair()`] mends what algorithms cannot take, and reports each change; what was asked for
//!   beyond that is in [`RepairOptions`].
//! * [`Topology`] and [`IntrinsicMesh`] are what algorithms work on: connectivity of any kind,
//!   non-manifold edges included, and edge lengths.
//! * [`laplacian`] has the stiffness and masses of functions on a surface of any kind.
//! * [`shapes`] are small analytic surfaces for tests, benches and documentation.
//!
//! **Invariant.** Vertices keep the order of their file: repair drops and merges, never reorders,
//! and says where each input vertex went.
//!
//! Knows nothing of distances, embeddings or matrices.
//!
//! ```no_run
//! use std::path::Path;
//!
//! # fn main() -> Result<(), canonform_mesh::MeshError> {
//! let mesh = canonform_mesh::io::read(Path::new("david0.vert"))?;
//! let repaired = canonform_mesh::repair(&mesh, &canonform_mesh::RepairOptions::default())?;
//! for line in repaired.report.summary() {
//!     eprintln!("{line}");
//! }
//! let surface = repaired.intrinsic();
//! # Ok(())
//! # }
//! ```

mod error;
mod face_set;
pub mod io;
mod orientation;
mod position_key;
mod repair;
pub mod shapes;
mod tri_mesh;
mod validate;

pub use error::{Fault, MeshError, Place};
pub use orientation::orient_consistently;
pub use repair::{ComponentPolicy, Orient, RepairOptions, RepairReport, Repaired, Weld, repair};
pub use tri_mesh::TriMesh;
pub use validate::{MeshReport, validate};
