//! Comparing two shapes, and all pairs of a collection.

mod comparison;
mod evidence;
mod forms;
mod meshes;

pub use comparison::{
    Comparison, Overlay, Residual, SurfaceComparison, Triangulation, compare, compare_surfaces,
};
pub use evidence::{
    Basis, Change, EvidenceKind, MatchEvidence, MeshGeometry, Parts, Side, SurfaceGap, UnitChange,
};
pub use forms::{FormMatches, embedded_distances, form_matches};
pub use meshes::{ComparedMesh, MeshComparison, compare_meshes};
