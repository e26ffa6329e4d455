//! Dense maps between two surfaces.

mod correspondence;
mod known;
mod mapped_surface;
mod options;
mod point_map;

pub use correspondence::{Correspondence, correspond, score_map};
pub use mapped_surface::MappedSurface;
pub use options::CorrespondOptions;
pub use point_map::{FacePoint, Mapping, PointMap};
