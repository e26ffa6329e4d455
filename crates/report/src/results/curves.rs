//! The record of a figure made of curves.

use serde::{Deserialize, Serialize};

use super::{Expectation, Provenance};
use crate::ReportError;

/// Curves over one quantity, in one or more panels: Figures 5 to 8 of the paper.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct CurvesRecord {
    /// What made it.
    pub provenance: Provenance,
    /// One sentence on what is drawn, under the picture.
    pub caption: String,
    /// The panels, in reading order.
    pub panels: Vec<CurvesPanel>,
    /// What was expected.
    pub expectations: Vec<Expectation>,
    /// What the figure shows, in paragraphs of plain text separated by empty lines.
    pub analysis: String,
}

/// One plot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CurvesPanel {
    /// What stands above it, for example the name of the shape.
    pub title: String,
    /// The quantity across.
    pub x: Axis,
    /// The quantity upwards.
    pub y: Axis,
    /// The curves; those of one name look alike in all panels.
    pub series: Vec<Series>,
    /// Places on the horizontal axis that have a name.
    pub marks: Vec<Mark>,
}

/// One axis of a plot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Axis {
    /// What is measured.
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
}

/// One curve and the band around it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Series {
    /// What the legend calls it.
    pub name: String,
    /// Its points, by ascending `x`.
    pub points: Vec<SeriesPoint>,
}

/// One point of a curve: what repeated runs gave at one place.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SeriesPoint {
    /// Place on the horizontal axis.
    pub x: f64,
    /// The median of the runs, where the line goes.
    pub median: f64,
    /// The least of the runs, the lower end of the band.
    pub low: f64,
    /// The greatest of the runs, the upper end of the band.
    pub high: f64,
    /// Number of runs.
    pub runs: usize,
}

/// A named place on the horizontal axis.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// Where.
    pub x: f64,
    /// What is there.
    pub name: String,
}

impl CurvesRecord {
    /// Checks that there is something to draw and that every number is finite.
    ///
    /// # Errors
    /// [`ReportError::Empty`] or [`ReportError::NotFinite`], naming the part of the record.
    pub fn validate(&self) -> Result<(), ReportError> {
        let points = |panel: &CurvesPanel| panel.series.iter().map(|s| s.points.len()).sum::<usize>();
        if self.panels.is_empty() || self.panels.iter().any(|panel| points(panel) == 0) {
            return Err(ReportError::Empty { figure: "a figure of curves", unit: "point in each panel" });
        }
        for panel in &self.panels {
            for series in &panel.series {
                for point in &series.points {
                    for value in [point.x, point.median, point.low, point.high] {
                        if !value.is_finite() {
                            let what =
                                format!("a point of {} in {} at {}", series.name, panel.title, point.x);
                            return Err(ReportError::NotFinite { what, value });
                        }
                    }
                }
            }
            for mark in &panel.marks {
                if !mark.x.is_finite() {
                    let what = format!("the mark {} in {}", mark.name, panel.title);
                    return Err(ReportError::NotFinite { what, value: mark.x });
                }
            }
        }
        Ok(())
    }
}
