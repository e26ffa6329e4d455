//! Figures, tables and the report page of experiments.
//!
//! `experiments` -> [`results`] (JSON) -> **report** -> SVG / PNG / text / one HTML page
//!
//! [`Results`] say which figures and tables show them. [`figure`] describes figures as data, which the static files
//! and the page draw; [`Table`] is written as text and as HTML. Nothing here computes results: every value that is
//! drawn or printed comes from a record.

mod classes;
mod curves;
mod error;
pub mod figure;
mod figure1;
mod figure3;
mod figure4;
mod figure9;
#[cfg(test)]
mod fixtures;
mod invariance;
pub mod page;
mod record;
pub mod results;
mod retrieval;
mod table;
mod tables;

pub use error::ReportError;
pub use record::{Results, save};
pub use table::{Cell, Table};
