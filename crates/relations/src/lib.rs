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
    ConsistentMaps, CycleReport, KnownMap, LandmarkConflict, MapElements, MapError, MapKind, MapShape,
    PartOfWhole, SurfaceMap, all_pairs, consistent_maps, map_surfaces, map_wholes, mapped_points,
};
pub use relation::{
    Basis, Change, CutPiece, Difference, Dimension, Evidence, Handedness, MeshGeometry, MeshOverlay,
    NearestOnSurface, Parts, Relation, RelationKind, Side, SurfaceGap, SurfaceInvariants, TriangleTree,
    UnitChange, handedness, in_four_digits,
};
