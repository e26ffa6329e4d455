//! Shaded images of surfaces, colour maps, a canvas for figures, and the 3D viewer of the web pages.
//!
//! `mesh::TriMesh` -> [`render`] -> [`RgbaImage`] -> PNG
//!
//! `mesh::TriMesh` -> [`interactive::Geometry`] (JSON) -> a scene in the browser
//!
//! Nothing here computes results; the crate only draws them.

pub mod canvas;
pub mod color;
mod color_map;
mod error;
mod image;
pub mod interactive;
pub mod numbers;
pub mod render;
#[cfg(test)]
mod testing;

pub use error::ViewError;
pub use image::RgbaImage;
