//! Dense maps between two surfaces.
//!
//! ```text
//! form, spectrum, distances -> MapShape
//! two of them -> maps of functions that fit, alignments of the forms -> maps of samples, refined
//!             -> SurfaceMap, the best of each orientation
//! one of them a part -> places of landmarks and samples by their distances -> SurfaceMap
//! ```

mod curvature;
mod error;
mod functional_map;
mod known;
mod local;
mod nearest_rows;
mod operators;
mod orientation;
mod part;
mod points;
mod search;
mod shape;
mod surface_map;
mod whole_or_part;

pub use error::{LandmarkConflict, MapError};
pub use known::KnownMap;
pub use points::{MapElements, mapped_points};
pub use shape::MapShape;
pub use surface_map::{MapKind, PartOfWhole, SurfaceMap};
pub use whole_or_part::map_surfaces;
