//! How two shapes are related, and dense maps between their surfaces.
//!
//! ```text
//! ShapeDistance -> Relation by descriptions -> with files and meshes: Relation { kind, changes, confidence, because }
//! form, spectrum, distances -> MapShape -> map_surfaces -> SurfaceMap
//! ```

mod maps;
mod outward;
mod relation;

pub use maps::{
    KnownMap, LandmarkConflict, MapElements, MapError, MapKind, MapShape, PartOfWhole, SurfaceMap,
    map_surfaces, mapped_points,
};
pub use relation::{
    Basis, Change, CutPiece, Difference, Dimension, Evidence, Handedness, MeshGeometry, MeshOverlay,
    NearestOnSurface, Parts, Relation, RelationKind, Side, SurfaceGap, SurfaceInvariants, TriangleTree,
    UnitChange, handedness, in_four_digits,
};
