//! Records of experiments, with their figures, tables and page; pictures of meshes, and surfaces in the browser.
//!
//! `experiments` -> [`Record`] (JSON) -> **report** -> SVG / text / one HTML page
//!
//! A record holds all that is shown as data: nothing here computes results, and every record is drawn in the same way.
//!
//! `mesh::TriMesh` -> [`render`] -> [`RgbaImage`] -> PNG, or [`viewer::Geometry`] (JSON) -> a scene in the browser.

pub mod color;
mod color_map;
mod error;
mod figure;
mod image;
mod markup;
pub mod numbers;
pub mod page;
pub mod record;
pub mod render;
mod table;
pub mod viewer;

pub use error::ReportError;
pub use image::RgbaImage;
pub use record::Record;
pub use table::{Cell, Table};
