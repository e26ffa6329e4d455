//! Dense maps between two surfaces.
//!
//! ```text
//! form, spectrum, distances -> MapShape
//! two of them -> maps of functions that fit, alignments of the forms -> maps of samples, refined
//!             -> SurfaceMap, the best of each orientation
//! ```

mod curvature;
mod functional_map;
mod nearest_rows;
mod operators;
mod orientation;
mod part;
mod search;
mod shape;

pub use part::PartOfWhole;
pub use search::{MapKind, MapOptions, SurfaceMap, map_surfaces};
pub use shape::MapShape;
