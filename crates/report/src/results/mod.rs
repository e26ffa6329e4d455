//! Records of experiments: everything that a figure, a table or the page shows, as JSON.
//!
//! A run writes its record once; figures, tables and the page are made of it as often as needed. Every record says how
//! it was made ([`Provenance`]), what was expected of it ([`Expectation`]) and, in a few paragraphs, what it shows.

mod common;
mod curves;
mod figure1;
mod figure3;
mod figure4;
mod figure9;
mod file;
mod retrieval;
mod shapes;

pub use common::{Expectation, Provenance, Scale};
pub use curves::{Axis, AxisScale, CurvesPanel, CurvesRecord, Mark, Series, SeriesPoint};
pub use figure1::{Figure1Record, Figure1Shape};
pub use figure3::{Figure3Form, Figure3Record, Figure3Shape, Figure3Stress};
pub use figure4::{Figure4Panel, Figure4Record};
pub use figure9::{Figure9Measured, Figure9Record, Figure9Row};
pub use file::{read, write};
pub use retrieval::{Classification, RetrievalRecord, RetrievalRow};
pub use shapes::{Motions, SHAPES_FILE, ShapesRecord, ShownForm, ShownShape};
