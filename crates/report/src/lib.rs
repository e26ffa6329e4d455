//! Pictures, tables and the page made of result records.
//!
//! `experiments` -> [`results`] (JSON) -> **report** -> SVG / PNG / text / one HTML page
//!
//! Knows nothing of how a number came about: every value drawn or printed here stands in a record.
//! The one thing it works out itself is where to put ink, such as a camera, a tick or a tile.

mod classes;
pub mod curves;
mod error;
pub mod figure1;
pub mod figure3;
pub mod figure4;
#[cfg(test)]
mod fixtures;
mod markers;
pub mod page;
pub mod results;
pub mod retrieval;
pub mod tables;

pub use error::ReportError;
