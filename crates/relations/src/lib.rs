//! How two shapes are related.
//!
//! ```text
//! ShapeDistance -> Relation by descriptions -> with files and meshes: Relation { kind, changes, confidence, because }
//! ```

mod relation;

pub use relation::{
    Basis, Change, CutPiece, Difference, Dimension, Evidence, Handedness, MeshGeometry, MeshOverlay,
    NearestOnSurface, Parts, Relation, RelationKind, SurfaceGap, SurfaceInvariants, TriangleTree, UnitChange,
    handedness, in_four_digits,
};
