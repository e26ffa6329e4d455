//! How two shapes, and all pairs of a collection, compare.

mod comparison;
mod distance;
mod forms;
mod handedness;
mod rerank;

pub use comparison::{
    Comparison, MatchKind, Overlay, SurfaceComparison, Triangulation, compare_forms, compare_surfaces,
    overlay_forms,
};
pub use distance::{SAME_BELOW, ShapeDistance};
pub use forms::{
    FormMatches, MATCHED_POINTS, PreparedForms, embedded_distances, form_distances, form_matches, map_of,
    prepare_form,
};
pub use handedness::Handedness;
pub use rerank::{FORM_UNIT, FORM_WEIGHT, combined_distance, rerank};
