//! How two shapes are related, and dense maps between their surfaces.
//!
//! ```text
//! ShapeDistance -> Relation by descriptions -> with files and meshes: Relation { kind, changes, confidence, because }
//! form, spectrum, distances -> MapShape -> map_surfaces -> SurfaceMap
//! ```

mod maps;
mod outward;
mod relation;
#[cfg(test)]
mod testing;

pub use maps::{MapKind, MapOptions, MapShape, SurfaceMap, map_surfaces};
pub use relation::{
    Basis, Because, Change, CutPiece, Difference, Dimension, Handedness, MeshGeometry, MeshOverlay, Parts,
    Relation, RelationKind, Side, SurfaceGap, UnitChange, handedness,
};
