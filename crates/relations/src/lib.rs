//! How two shapes are related.
//!
//! ```text
//! ShapeDistance -> Relation by descriptions -> with files and meshes: Relation { kind, changes, confidence, because }
//! ```

mod relation;

pub use relation::{
    Basis, Change, CutPiece, Difference, Dimension, Evidence, Merit, MeshGeometry, MeshOverlay, Parts,
    Relation, RelationKind, SurfaceInvariants, UnitChange, in_four_digits,
};
