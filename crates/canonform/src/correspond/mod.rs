//! Dense maps between two surfaces.

mod correspondence;
mod mapped_surface;
mod options;

pub use correspondence::{Correspondence, VertexMap, correspond};
pub use mapped_surface::MappedSurface;
pub use options::CorrespondOptions;
