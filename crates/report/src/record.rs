//! The record of an experiment: all that its figures, tables and section of the page show, as JSON.
//!
//! A run writes its [`Record`] once; figures, tables and the page are made from it as often as needed.

use std::collections::{BTreeMap, HashSet};
use std::path::Path;

use base::files::{FileError, write_bytes};
use serde::{Deserialize, Serialize};

use crate::error::ReportError;
use crate::table::Table;
use crate::viewer::Geometry;

/// The results of an experiment with their context, as `NAME.json` holds them.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Record {
    /// How they were made.
    pub provenance: RunProvenance,
    /// The sentences with which a page can begin; may be empty.
    pub lead: String,
    /// What the results show, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// Numbers by name, which expectations and texts use.
    pub measured: BTreeMap<String, f64>,
    /// The tables; a run prints the first.
    pub tables: Vec<Table>,
    /// The figures.
    pub figures: Vec<Figure>,
}

/// How a record was made.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct RunProvenance {
    /// Name of the program.
    pub program: String,
    /// Its version.
    pub version: String,
    /// The commit it was built from, with `+` if files had changed since; empty if unknown.
    pub commit: String,
    /// When the run ended, in UTC, for example `2026-01-31 12:00`.
    pub date: String,
    /// Processor, number of worker threads and operating system.
    pub machine: String,
    /// The command line that repeats the run.
    pub command: String,
    /// The source of the shapes: a folder, or the name of a built-in dataset.
    pub dataset: String,
    /// The classes in use, in the order of the command line.
    pub classes: Vec<String>,
    /// The seed of all random numbers.
    pub seed: u64,
    /// Every option of every stage.
    pub options: serde_json::Map<String, serde_json::Value>,
    /// Wall-clock seconds of the run.
    pub seconds: f64,
}

/// An expected and a measured number.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Expectation {
    /// What was measured, for example `NMDS, raw: first tier`.
    pub what: String,
    /// The expected range, for example `at least 0.99`.
    pub expected: String,
    /// The measured value, for example `0.994`.
    pub measured: String,
    /// Whether the measured value is in the expected range.
    pub held: bool,
    /// Whether this is a goal that is known to be missed, so that missing it is no failure.
    pub goal: bool,
}

/// Panels under one caption: one static figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// What follows the name of the experiment in the names of the files, for example `curves`.
    pub part: String,
    /// What the figure shows.
    pub caption: String,
    /// The panels, in reading order.
    pub panels: FigurePanels,
}

/// The panels of a figure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum FigurePanels {
    /// Series over two axes.
    Plots(Vec<Plot>),
    /// Matrices of colored cells.
    Heats(Vec<Heat>),
    /// Surfaces.
    Tiles(Tiles),
}

/// Series over two axes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Plot {
    /// The heading, for example the name of the shape.
    pub title: String,
    /// The quantity on the horizontal axis.
    pub x: Axis,
    /// The quantity on the vertical axis.
    pub y: Axis,
    /// The series in the order of the legend; the first covers the others. Those of one name look alike in all plots.
    pub series: Vec<Series>,
    /// Named values of the horizontal axis: vertical lines, or the categories.
    pub marks: Vec<Mark>,
}

/// One axis of a plot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// The quantity.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// How values are spaced.
    pub scale: AxisScale,
}

/// How values are spaced along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum AxisScale {
    /// Equal differences.
    Linear,
    /// Equal differences, of the same length on both axes.
    Map,
    /// Equal ratios; values that are not positive cannot be shown.
    Log,
    /// Categories at 0, 1, 2 and so on, which the marks name. Series stand beside each other.
    Category,
}

/// Points of one name and look.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// How the points are drawn.
    pub kind: SeriesKind,
    /// The points, by ascending `x` if they form a curve.
    pub points: Vec<PlotPoint>,
}

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum SeriesKind {
    /// A line with markers, and a band from the lower to the upper ends of the points.
    Curve,
    /// Markers with error bars.
    Filled,
    /// Hollow markers: the numbers printed in the paper for the series of this name.
    Hollow,
}

/// A value with the range around it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct PlotPoint {
    /// The place on the horizontal axis.
    pub x: f64,
    /// The value; of repeated runs the median.
    pub y: f64,
    /// The lower end of the range; of repeated runs the least.
    pub low: f64,
    /// The upper end of the range; of repeated runs the greatest.
    pub high: f64,
    /// What the page adds when the reader points at it.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// A named value of the horizontal axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// The value.
    pub x: f64,
    /// Its name.
    pub name: String,
}

/// A square matrix of colored cells, rows from top to bottom.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Heat {
    /// The heading; may be empty.
    pub title: String,
    /// Names of the rows, which are those of the columns; equal neighbors are a group that is named once, and lines separate
    /// groups.
    pub names: Vec<String>,
    /// The value of every cell, row by row.
    pub values: Vec<Vec<f64>>,
    /// The quantity, for the color bar.
    pub quantity: Axis,
}

/// Rows of surfaces. Those of row number `n` have the color of class number `n`.
///
/// Shapes have the default view; all forms of a row share the view of the principal axes of the first one.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Tiles {
    /// Whether a tile belongs to the one beside it, not to the whole row.
    pub is_paired: bool,
    /// Headings of the columns.
    pub heads: Vec<String>,
    /// The rows.
    pub rows: Vec<TileRow>,
}

/// Surfaces beside each other.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TileRow {
    /// The heading.
    pub name: String,
    /// The surfaces.
    pub tiles: Vec<Tile>,
}

/// A surface, with lines of text under it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Tile {
    /// The lines, pale from the second on.
    pub captions: Vec<String>,
    /// Whether it is a canonical form, not a shape.
    pub is_form: bool,
    /// The surface.
    pub surface: Geometry,
}

impl Axis {
    /// A linear axis of a pure number.
    pub fn linear(name: &str) -> Self {
        Self { name: name.to_owned(), unit: String::new(), scale: AxisScale::Linear }
    }

    /// A logarithmic axis.
    pub fn log(name: &str, unit: &str) -> Self {
        Self { unit: unit.to_owned(), scale: AxisScale::Log, ..Self::linear(name) }
    }
}

impl PlotPoint {
    /// A value without a range.
    pub fn new(x: f64, y: f64, note: impl Into<String>) -> Self {
        Self { x, y, low: y, high: y, note: note.into() }
    }
}

impl Record {
    /// Reads a record.
    ///
    /// # Errors
    /// [`ReportError::File`] if the file cannot be read, [`ReportError::Parse`] if it is not such a record.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, ReportError> {
        let path = path.as_ref();
        Self::parse(path, &std::fs::read(path).map_err(|source| FileError::read(path, source))?)
    }

    fn parse(path: &Path, json: &[u8]) -> Result<Self, ReportError> {
        serde_json::from_slice(json).map_err(|source| ReportError::Parse { path: path.to_path_buf(), source })
    }

    /// Writes the figures and then `NAME.json` into a folder, each file completely or not at all.
    ///
    /// # Errors
    /// [`ReportError::Parse`] if a number is not finite, so that it would not read back; [`ReportError::Draw`] or
    /// [`ReportError::File`] if drawing or writing fails.
    pub fn save(&self, folder: &Path, name: &str) -> Result<(), ReportError> {
        let path = folder.join(format!("{name}.json"));
        let mut json = serde_json::to_vec_pretty(self).map_err(|e| FileError::write(&path, e.into()))?;
        json.push(b'\n');
        Self::parse(&path, &json)?;
        for figure in &self.figures {
            figure.save(folder, name)?;
        }
        Ok(write_bytes(&path, &json)?)
    }
}

/// Distinct names in the order of their first appearance, for colors and markers.
pub(crate) fn distinct<'a>(all: impl Iterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = HashSet::new();
    all.filter(|name| seen.insert(*name)).collect()
}
