//! Records of experiments: everything that a figure, a table or the page shows, as JSON.
//!
//! A run writes its [`Record`] once; figures, tables and the page are made from it as often as needed.

mod common;
mod curves;
mod figure1;
mod figure3;
mod figure4;
mod figure9;
mod file;
mod invariance;
mod retrieval;
mod shapes;
mod tables;

pub use common::{Expectation, ExpectationOutcome, Record, RunProvenance, Scale};
pub use curves::{Axis, AxisScale, CurvesPanel, CurvesResults, Mark, Series, SeriesPoint};
pub use figure1::{Figure1Results, Figure1Shape};
pub use figure3::{Figure3Form, Figure3Results, Figure3Shape, Figure3Stress};
pub use figure4::{Figure4Panel, Figure4Results};
pub use figure9::{Figure9Measured, Figure9Results, Figure9Row};
pub use file::{provenance, read, write};
pub use invariance::{InvarianceResults, InvarianceRow, SignatureChange};
pub use retrieval::{
    BothRankings, Classification, Misclassified, Published, PublishedMethod, RankedScores, RetrievalResults,
    RetrievalRow,
};
pub use shapes::{Motions, SHAPES_FILE, ShapesRecord, ShownForm, ShownShape};
pub use tables::{RecordedTable, TableEntry, TablesResults};
