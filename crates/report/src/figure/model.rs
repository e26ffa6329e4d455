//! The parts of a figure.

use serde::{Serialize, Serializer};

use super::axis::PlotAxis;
use super::style::SeriesStyle;
use crate::classes::Classes;
use crate::color::Rgb;
use crate::results::{Axis, AxisScale, Mark};
use crate::viewer::base64::encode;

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
    pub panels: FigurePanels,
}

/// The panels of a figure.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum FigurePanels {
    /// PlotSeries over two axes.
    Plots(Vec<Plot>),
    /// Matrices of coloured cells.
    Heats(Vec<Heat>),
    /// Rendered surfaces. Records hold no meshes, so the run itself draws them as [`Tiles`](super::Tiles).
    Surfaces,
}

/// PlotSeries over two axes.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Plot {
    /// The heading.
    pub title: String,
    /// A description for readers who cannot see the plot.
    pub label: String,
    /// The horizontal axis.
    pub x: PlotAxis,
    /// The vertical axis.
    pub y: PlotAxis,
    /// Whether both axes have the same scale, as a map has.
    pub is_map: bool,
    /// The series in the order of the legend; the first covers the others.
    pub series: Vec<PlotSeries>,
    /// Vertical lines at named values.
    pub marks: Vec<Mark>,
    /// Scores that a static figure lists under the plot.
    #[serde(skip)]
    pub scores: Vec<(&'static str, String)>,
}

impl Plot {
    /// A plot over axes of these quantities that hold all series and marks. Over categories, which the marks name, series are
    /// not lines but stand beside each other.
    #[must_use]
    pub fn new(
        title: &str,
        label: String,
        x: &Axis,
        y: &Axis,
        mut series: Vec<PlotSeries>,
        mut marks: Vec<Mark>,
    ) -> Self {
        let x = if x.scale == AxisScale::Category {
            let n = series.len();
            for (i, one) in series.iter_mut().enumerate() {
                one.kind = SeriesKind::Filled;
                one.points.iter_mut().for_each(|point| point.x += beside(i, n));
            }
            PlotAxis::categories(&x.name, marks.drain(..).map(|mark| mark.name))
        } else {
            let points = series.iter().flat_map(|series| &series.points).map(|p| p.x);
            PlotAxis::holding(x, points.chain(marks.iter().map(|mark| mark.x)))
        };
        let points = || series.iter().flat_map(|series| &series.points);
        let y = PlotAxis::holding(y, points().flat_map(|p| [p.low, p.y, p.high]));
        Self { title: title.to_owned(), label, x, y, is_map: false, series, marks, scores: vec![] }
    }
}

/// Points of one name and look.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PlotSeries {
    /// The name in the legend. PlotSeries of one name and shape share their entry there.
    pub name: String,
    /// Colour and marker.
    pub style: SeriesStyle,
    /// How the points are drawn.
    #[serde(rename = "shape")]
    pub kind: SeriesKind,
    /// The points, by ascending `x` if they form a curve.
    pub points: Vec<PlotPoint>,
}

/// How the points of a series are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SeriesKind {
    /// A line with markers, and a band from the lower to the upper ends of the points.
    Curve,
    /// Markers with error bars.
    Filled,
    /// Hollow markers with error bars.
    Hollow,
}

/// A value with the range around it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PlotPoint {
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

impl PlotPoint {
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
    pub x: PlotAxis,
    /// The vertical axis. Its range runs from the bottom to the top, so it is descending.
    pub y: PlotAxis,
    /// The value of every cell, row by row.
    #[serde(serialize_with = "single_precision")]
    pub values: Vec<Vec<f64>>,
    /// The value of the last colour; the first colour is that of zero.
    pub max: f64,
    /// The last colour, of a scale that begins with that of the page; `None` for the perceptual colour map.
    pub tint: Option<Rgb>,
    /// Axis of the colour bar beside the matrix, if it has one.
    pub bar: Option<PlotAxis>,
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

/// The value of a series at a category.
#[derive(Debug, Clone)]
pub struct GroupedValue<'a> {
    /// Name of the category.
    pub category: &'a str,
    /// Name of the series.
    pub series: &'a str,
    /// Our value, with any `x`, if there is one.
    pub own: Option<PlotPoint>,
    /// The value printed in the paper, if there is one.
    pub paper: Option<f64>,
}

/// Where the `i`-th of `n` series stands beside the middle of a category.
fn beside(i: usize, n: usize) -> f64 {
    (i as f64 - (n as f64 - 1.0) / 2.0) * 0.7 / n as f64
}

/// A plot of our values (filled) and the paper's (hollow, with the name that `paper` makes of that of the series) over
/// a vertical axis of this quantity. PlotSeries without a value are left out.
pub fn grouped(title: &str, quantity: &Axis, groups: &[GroupedValue<'_>], paper: fn(&str) -> String) -> Plot {
    let categories = Classes::of(groups.iter().map(|group| group.category));
    let is_known = |group: &&GroupedValue<'_>| group.own.is_some() || group.paper.is_some();
    let names = Classes::of(groups.iter().filter(is_known).map(|group| group.series));
    let n = names.names().len();
    let mut series = Vec::new();
    for (i, name) in names.names().iter().enumerate() {
        let side = beside(i, n);
        let members = || groups.iter().filter(|group| group.series == *name);
        let x = |group: &GroupedValue<'_>| categories.index(group.category) as f64 + side;
        let own = members().filter_map(|g| Some(PlotPoint { x: x(g), ..g.own.clone()? }));
        let printed = members().filter_map(|g| Some(PlotPoint::new(x(g), g.paper?, "")));
        for (name, kind, points) in [
            ((*name).to_owned(), SeriesKind::Filled, own.collect::<Vec<_>>()),
            (paper(name), SeriesKind::Hollow, printed.collect()),
        ] {
            if !points.is_empty() {
                series.push(PlotSeries { name, style: SeriesStyle(i), kind, points });
            }
        }
    }
    let label = format!("{}: {title}", quantity.name);
    let x = PlotAxis::categories("", categories.names().iter().map(|name| (*name).to_owned()));
    Plot { x, ..Plot::new(title, label, quantity, quantity, series, vec![]) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn over_categories_series_stand_beside_each_other_and_marks_name_them() {
        let axis = |scale| Axis { name: "by".to_owned(), unit: String::new(), scale };
        let one = |name: &str| PlotSeries {
            name: name.to_owned(),
            style: SeriesStyle(0),
            kind: SeriesKind::Curve,
            points: [0.0, 1.0].map(|x| PlotPoint::new(x, 2.0, "")).to_vec(),
        };
        let marks = ["views", "spectrum"].into_iter().zip([0.0, 1.0]);
        let marks = marks.map(|(name, x)| Mark { x, name: name.to_owned() }).collect();
        let [x, y] = [AxisScale::Category, AxisScale::Linear].map(axis);
        let plot = Plot::new("", String::new(), &x, &y, vec![one("a"), one("b")], marks);
        assert_eq!(plot.x.ticks, [(0.0, "views".to_owned()), (1.0, "spectrum".to_owned())]);
        assert!(plot.marks.is_empty() && plot.series.iter().all(|one| one.kind == SeriesKind::Filled));
        for (i, [a, b]) in
            [0, 1].map(|i| [0, 1].map(|k: usize| plot.series[k].points[i].x)).into_iter().enumerate()
        {
            assert!(a < i as f64 && b > i as f64 && b - a < 0.5, "{a} {b}");
        }
    }
}
