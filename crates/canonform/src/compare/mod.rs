//! Comparing two shapes, and all pairs of a collection.

mod comparison;
mod forms;
mod meshes;

pub use comparison::{Comparison, FaceAgreement, Overlay, Residual, compare};
pub use forms::{embedded_distances, form_alignments};
pub use meshes::{Compared, ComparedMesh, MeshComparison, compare_meshes};
