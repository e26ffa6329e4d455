//! Dense maps between two surfaces.
//!
//! ```text
//! form, spectrum, distances -> MapShape
//! two of them -> alignments of the forms -> maps of samples, refined -> SurfaceMap, the best of each orientation
//! ```

mod functional_map;
mod nearest_rows;
mod orientation;
mod search;
mod shape;

pub use search::{MapKind, MapOptions, SurfaceMap, map_surfaces};
pub use shape::MapShape;
