//! Figures, tables and the report page of experiments.
//!
//! `experiments` -> [`results`] (JSON) -> **report** -> SVG / PNG / text / one HTML page
//!
//! [`Results`] say which figures and tables show them. [`figure`] describes figures as data, which the static files
//! and the page draw; [`Table`] is written as text and as HTML. Nothing here computes results: every value that is
//! drawn or printed comes from a record.
//!
//! `mesh::TriMesh` -> [`render`] -> [`RgbaImage`] -> PNG, or [`viewer::Geometry`] (JSON) -> a scene in the browser.

mod classes;
pub mod color;
mod color_map;
mod curves;
mod error;
pub mod figure;
mod figure1;
mod figure3;
mod figure4;
mod figure9;
mod image;
mod invariance;
pub mod numbers;
pub mod page;
mod record;
pub mod render;
pub mod results;
mod retrieval;
mod table;
mod tables;
#[cfg(test)]
mod tests;
pub mod viewer;

pub use error::ReportError;
pub use image::RgbaImage;
pub use record::{Results, save};
pub use table::{Cell, Table};
