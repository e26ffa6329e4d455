//! Shaded images of triangle meshes, rendered in software: no window, graphics card or system library.
//!
//! The mesh is turned into the view ([`View`]), its triangles are drawn into a depth buffer finer than the image,
//! every visible sample is lit, and the samples of a pixel are averaged in linear light. The same mesh and options
//! give the same bytes.

mod bar;
mod camera;
mod coloring;
mod dots;
mod draw;
mod normals;
mod options;
mod raster;
mod shade;
mod text;

pub use bar::annotated;
pub use camera::{View, aspect};
pub use coloring::Coloring;
pub use dots::dots;
pub use draw::render;
pub use options::{Background, RenderOptions};
pub use text::{Label, Title, collage};

pub use crate::color::value_range;
