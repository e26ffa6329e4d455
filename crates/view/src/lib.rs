//! Shaded pictures of surfaces, colour maps, a drawing canvas, and the 3D viewer of pages.
//!
//! `mesh::TriMesh` -> [`render`] -> [`RgbaImage`] -> PNG
//!
//! `mesh::TriMesh` -> [`interactive::Geometry`] (JSON) -> a scene in the browser
//!
//! Knows nothing of how a number was computed: it places ink, such as a camera, a colour or a tick.

pub mod canvas;
pub mod color;
mod error;
mod image;
pub mod interactive;
pub mod numbers;
pub mod render;
#[cfg(test)]
mod testing;

pub use error::ViewError;
pub use image::RgbaImage;
