//! Dense maps between two surfaces.
//!
//! ```text
//! form, spectrum, distances -> MapShape
//! two of them -> maps of functions that fit, alignments of the forms -> maps of samples, refined
//!             -> SurfaceMap, the best of each orientation
//! ```

mod curvature;
mod functional_map;
mod known;
mod local;
mod nearest_rows;
mod network;
mod operators;
mod orientation;
mod points;
mod search;
mod shape;
mod surface_map;

pub use known::KnownMap;
pub use network::{ConsistentMaps, CycleReport, all_pairs, consistent_maps};
pub use points::{MapElements, mapped_points};
pub use search::{MapOptions, map_surfaces};
pub use shape::MapShape;
pub use surface_map::{MapKind, SurfaceMap};
