//! The record of a figure of curves.

use serde::{Deserialize, Serialize};

use super::tables::RecordedTable;

/// Curves over one quantity, in one or more panels: Figures 5 to 8 of the paper.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CurvesResults {
    /// What the figure shows, in one or two sentences.
    pub caption: String,
    /// The panels, in reading order.
    pub panels: Vec<CurvesPanel>,
    /// Tables that stand before those of the panels; a run prints the first of them in place of the medians.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tables: Vec<RecordedTable>,
}

/// One plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurvesPanel {
    /// The heading, for example the name of the shape.
    pub title: String,
    /// The quantity on the horizontal axis.
    pub x: Axis,
    /// The quantity on the vertical axis.
    pub y: Axis,
    /// The curves; those of one name look alike in all panels.
    pub series: Vec<Series>,
    /// Named values of the horizontal axis.
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
    /// Equal ratios; values that are not positive cannot be shown.
    Log,
    /// Categories at 0, 1, 2 and so on.
    Category,
}

/// One curve and the band around it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// The name in the legend.
    pub name: String,
    /// Its points, by ascending `x`.
    pub points: Vec<SeriesPoint>,
}

/// One point of a curve: the results of repeated runs at one value of `x`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesPoint {
    /// The value on the horizontal axis.
    pub x: f64,
    /// The median of the runs, on the line.
    pub median: f64,
    /// The least of the runs, the lower end of the band.
    pub low: f64,
    /// The greatest of the runs, the upper end of the band.
    pub high: f64,
    /// Number of runs.
    pub runs: usize,
}

/// A named value of the horizontal axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// The value.
    pub x: f64,
    /// Its name.
    pub name: String,
}
