//! Dense maps between two surfaces.
//!
//! ```text
//! form, spectrum, distances -> MapShape
//! two of them -> Start (fitted maps of functions, aligned forms) -> Sketch -> Scored -> Refined -> SurfaceMap, of each orientation
//! one of them a part -> places of landmarks and samples by their distances -> SurfaceMap
//! ```

mod curvature;
mod error;
mod functional;
mod known;
mod local;
mod mirror;
mod nearest_rows;
mod operators;
mod orientation;
mod params;
mod part;
mod points;
mod refine;
mod score;
mod search;
mod shape;
mod sketch;
mod start;
mod surface_map;
mod surfaces;

pub use error::{LandmarkConflict, MapError};
pub use known::KnownMap;
pub use params::MapParams;
pub use points::{MapElements, mapped_points};
pub use shape::MapShape;
pub use surface_map::{MapKind, PartOfWhole, SurfaceMap};
pub use surfaces::{map_surfaces, score_map};
