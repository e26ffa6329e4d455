//! Dense maps between two surfaces.

mod correspondence;
mod matched_surface;
mod options;

pub use correspondence::{Correspondence, VertexMap, correspond};
pub use matched_surface::MatchedSurface;
pub use options::CorrespondOptions;
