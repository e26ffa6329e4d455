//! Comparing two shapes, and all pairs of a collection.

mod comparison;
mod forms;

pub use comparison::{
    Comparison, Overlay, Residual, SurfaceComparison, Triangulation, compare, compare_surfaces,
};
pub use forms::{FormMatches, embedded_distances, form_matches};
