//! The parts of a figure.

use serde::{Serialize, Serializer};

use super::axis::Axis;
use super::style::Style;
use crate::results::{Axis as Quantity, Mark};
use view::color::Rgb;
use view::interactive::base64::encode;

/// Panels under one caption: one static figure, and one chart on the page.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Figure {
    /// What follows the name of the experiment in the names of the files, for example `-curves`.
    #[serde(skip)]
    pub part: &'static str,
    /// What the figure shows.
    #[serde(skip)]
    pub caption: String,
    /// The panels, in reading order.
    #[serde(flatten)]
    pub content: Content,
}

/// The panels of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Content {
    /// Series over two axes.
    Plots(Vec<Plot>),
    /// Matrices of coloured cells.
    Heats(Vec<Heat>),
    /// Rendered surfaces. Records hold no meshes, so the run itself draws them as [`Tiles`](super::Tiles).
    Surfaces,
}

/// Series over two axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plot {
    /// The heading.
    pub title: String,
    /// A description for readers who cannot see the plot.
    pub label: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis.
    pub y: Axis,
    /// Whether both axes have the same scale, as a map has.
    pub is_map: bool,
    /// The series in the order of the legend; the first covers the others.
    pub series: Vec<Series>,
    /// Vertical lines at named values.
    pub marks: Vec<Mark>,
    /// Scores that a static figure lists under the plot.
    #[serde(skip)]
    pub scores: Vec<(&'static str, String)>,
}

impl Plot {
    /// A plot over axes of these quantities that hold all series and marks.
    #[must_use]
    pub fn new(
        title: &str,
        label: String,
        x: &Quantity,
        y: &Quantity,
        series: Vec<Series>,
        marks: Vec<Mark>,
    ) -> Self {
        let points = || series.iter().flat_map(|series| &series.points);
        let x = Axis::holding(x, points().map(|p| p.x).chain(marks.iter().map(|mark| mark.x)));
        let y = Axis::holding(y, points().flat_map(|p| [p.low, p.y, p.high]));
        Self { title: title.to_owned(), label, x, y, is_map: false, series, marks, scores: vec![] }
    }
}

/// Points of one name and look.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Series {
    /// The name in the legend. Series of one name and shape share their entry there.
    pub name: String,
    /// Colour and marker.
    pub style: Style,
    /// How the points are drawn.
    pub shape: Shape,
    /// The points, by ascending `x` if they form a curve.
    pub points: Vec<Point>,
}

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Shape {
    /// A line with markers, and a band from the lower to the upper ends of the points.
    Curve,
    /// Markers with error bars.
    Filled,
    /// Hollow markers with error bars.
    Hollow,
}

/// A value with the range around it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Point {
    /// The place on the horizontal axis.
    pub x: f64,
    /// The value.
    pub y: f64,
    /// The lower end of the range.
    pub low: f64,
    /// The upper end of the range.
    pub high: f64,
    /// What the page adds when the reader points at it; may be empty.
    pub note: String,
}

impl Point {
    /// A value without a range.
    pub fn new(x: f64, y: f64, note: impl Into<String>) -> Self {
        Self { x, y, low: y, high: y, note: note.into() }
    }
}

/// A matrix of coloured cells, rows from top to bottom.
///
/// Cell `i` of a row or column is centred at `i` on its axis.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Heat {
    /// The heading; may be empty.
    pub title: String,
    /// A description for readers who cannot see the matrix.
    pub label: String,
    /// The horizontal axis.
    pub x: Axis,
    /// The vertical axis. Its range runs from the bottom to the top, so it is descending.
    pub y: Axis,
    /// The value of every cell, row by row.
    #[serde(serialize_with = "single_precision")]
    pub values: Vec<Vec<f64>>,
    /// The value of the last colour; the first colour is that of zero.
    pub max: f64,
    /// The last colour, of a scale that begins with that of the page; `None` for the perceptual colour map.
    pub tint: Option<Rgb>,
    /// Axis of the colour bar beside the matrix, if it has one.
    pub bar: Option<Axis>,
    /// The rows, and columns, before which a line separates groups.
    pub borders: Vec<usize>,
    /// Counts written in the cells; cells with zero stay empty. Without counts, cells have no grid.
    pub counts: Option<Vec<Vec<usize>>>,
    /// Names of the rows.
    pub rows: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// What the page says of a cell: `{row}`, `{column}`, `{value}`, `{percent}` and `{count}` are replaced.
    pub hover: &'static str,
}

fn single_precision<S: Serializer>(values: &[Vec<f64>], to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(&encode(values.iter().flatten().map(|&value| value as f32)))
}
