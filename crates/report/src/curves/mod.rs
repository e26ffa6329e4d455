//! Figures made of curves: medians of repeated runs as lines, all runs as bands.

mod axis;

use std::path::{Path, PathBuf};

use plotters::prelude::*;

use crate::ReportError;
use crate::classes::Classes;
use crate::markers::draw_marker;
use crate::results::{CurvesPanel, CurvesRecord, Series};
use axis::Span;
use view::canvas::{
    Anchor, Canvas, DrawError, Drawing, GRID, INK, PALE_INK, SMALL, TEXT, TITLE, Type, save, text_width,
};
use view::color::{class_color, mix};

/// What is appended to the stem of the files, before `.png` and `.svg`.
pub const PART: &str = "-curves";

/// Draws the panels of a record, two in a row, and returns the paths of `STEM-curves.png` and
/// `STEM-curves.svg`. On a logarithmic axis what is not positive is left out.
///
/// # Errors
/// Those of [`CurvesRecord::validate`], [`ReportError::View`].
pub fn curves(record: &CurvesRecord, stem: impl AsRef<Path>) -> Result<Vec<PathBuf>, ReportError> {
    record.validate()?;
    let names = record.panels.iter().flat_map(|panel| panel.series.iter().map(|s| s.name.as_str()));
    let mut stem = stem.as_ref().as_os_str().to_owned();
    stem.push(PART);
    Ok(save(&Plots { panels: &record.panels, names: Classes::of(names) }, Path::new(&stem))?)
}

/// Measures of the figure, in units.
const WIDTH: f64 = 1000.0;
const TITLE_HEIGHT: f64 = 36.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 14.0;
const PLOT_HEIGHT: f64 = 340.0;
const UNDER: f64 = 62.0;
const LEGEND: Type = Type::new(TEXT, Anchor::Left);
const LEGEND_LINE: f64 = 28.0;
/// Width of the lines of curves.
const STROKE: f64 = 2.0;
/// How much of a curve's colour its band has.
const BAND: f64 = 0.16;

struct Plots<'a> {
    panels: &'a [CurvesPanel],
    names: Classes<'a>,
}

/// A plot's rectangle and the ranges of its axes.
struct Frame {
    left: f64,
    top: f64,
    width: f64,
    x: Span,
    y: Span,
}

impl Frame {
    fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (self.left + self.width * self.x.share(x), self.top + PLOT_HEIGHT * (1.0 - self.y.share(y)))
    }
}

impl Drawing for Plots<'_> {
    fn size(&self) -> (u32, u32) {
        let rows = self.panels.len().div_ceil(self.columns()) as f64;
        let legend = self.legend_lines().len() as f64 * LEGEND_LINE;
        (WIDTH as u32, (legend + rows * (TITLE_HEIGHT + PLOT_HEIGHT + UNDER) + 16.0) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        let top = self.legend(canvas)?;
        let column = WIDTH / self.columns() as f64;
        for (i, panel) in self.panels.iter().enumerate() {
            let left = (i % self.columns()) as f64 * column + LEFT;
            let row = (i / self.columns()) as f64;
            let frame = Frame {
                left,
                top: top + row * (TITLE_HEIGHT + PLOT_HEIGHT + UNDER) + TITLE_HEIGHT,
                width: column - LEFT - RIGHT,
                x: Span::across(panel),
                y: Span::upwards(panel),
            };
            self.panel(canvas, panel, &frame)?;
        }
        Ok(())
    }
}

impl Plots<'_> {
    fn columns(&self) -> usize {
        self.panels.len().clamp(1, 2)
    }

    fn legend_width(&self, name: usize) -> f64 {
        72.0 + text_width(self.names.name(name), LEGEND)
    }

    /// The names on each line of the legend.
    fn legend_lines(&self) -> Vec<Vec<usize>> {
        let mut lines: Vec<Vec<usize>> = Vec::new();
        let mut used = f64::INFINITY;
        for name in 0..self.names.len() {
            let width = self.legend_width(name);
            if used + width > WIDTH - 40.0 {
                lines.push(Vec::new());
                used = 0.0;
            }
            used += width;
            lines.last_mut().into_iter().for_each(|line| line.push(name));
        }
        lines
    }

    /// Draws the legend at the top and returns where it ends.
    fn legend<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<f64, DrawError> {
        let mut top = 6.0;
        for line in self.legend_lines() {
            let width: f64 = line.iter().map(|&name| self.legend_width(name)).sum();
            let mut left = (WIDTH - width) / 2.0 + 12.0;
            for name in line {
                let middle = top + LEGEND_LINE / 2.0;
                canvas.line((left, middle), (left + 32.0, middle), STROKE, color(name))?;
                draw_marker(canvas, name, (canvas.px(left + 16.0), canvas.px(middle)))?;
                canvas.text(self.names.name(name), (left + 42.0, middle), LEGEND)?;
                left += self.legend_width(name);
            }
            top += LEGEND_LINE;
        }
        Ok(top)
    }

    fn panel<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        panel: &CurvesPanel,
        frame: &Frame,
    ) -> Result<(), DrawError> {
        let middle = frame.left + frame.width / 2.0;
        let title = Type::new(TITLE, Anchor::Center).bold();
        canvas.text(&panel.title, (middle, frame.top - TITLE_HEIGHT / 2.0), title)?;
        axes(canvas, panel, frame)?;
        let order = |series: &&Series| self.names.index(&series.name);
        // The first names are drawn last, above the others.
        let mut series: Vec<&Series> = panel.series.iter().collect();
        series.sort_by_key(|s| std::cmp::Reverse(order(s)));
        for one in &series {
            band(canvas, one, order(one), frame)?;
        }
        for one in &series {
            line(canvas, one, order(one), frame)?;
        }
        Ok(())
    }
}

fn color(name: usize) -> RGBColor {
    let [r, g, b] = class_color(name);
    RGBColor(r, g, b)
}

/// Grid, frame, numbers, names of the axes, marks.
fn axes<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    panel: &CurvesPanel,
    frame: &Frame,
) -> Result<(), DrawError> {
    let (left, top) = (frame.left, frame.top);
    let (right, bottom) = (left + frame.width, top + PLOT_HEIGHT);
    let (across, x_name) = frame.x.ticks(&panel.x);
    let (upwards, y_name) = frame.y.ticks(&panel.y);
    for (value, text) in across {
        let at = left + frame.width * frame.x.share(value);
        canvas.line((at, top), (at, bottom), 1.0, GRID)?;
        canvas.text(&text, (at, bottom + 15.0), Type::new(SMALL, Anchor::Center))?;
    }
    for (value, text) in upwards {
        let at = bottom - PLOT_HEIGHT * frame.y.share(value);
        canvas.line((left, at), (right, at), 1.0, GRID)?;
        canvas.text(&text, (left - 8.0, at), Type::new(SMALL, Anchor::Right))?;
    }
    canvas.line((left, top), (left, bottom), 1.0, PALE_INK)?;
    canvas.line((left, bottom), (right, bottom), 1.0, PALE_INK)?;
    let name = Type::new(TEXT, Anchor::Center);
    canvas.text(&x_name, ((left + right) / 2.0, bottom + 40.0), name)?;
    canvas.text(&y_name, (left - LEFT + 14.0, (top + bottom) / 2.0), name.up())?;
    for mark in &panel.marks {
        let at = left + frame.width * frame.x.share(mark.x);
        canvas.line((at, top), (at, bottom), 1.5, INK)?;
        let kind = Type::new(SMALL, Anchor::Center).up();
        let middle = top + 8.0 + text_width(&mark.name, Type::new(SMALL, Anchor::Left)) / 2.0;
        canvas.text(&mark.name, (at - 10.0, middle), kind)?;
    }
    Ok(())
}

/// The range of all runs, where it can be shown.
fn band<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    series: &Series,
    name: usize,
    frame: &Frame,
) -> Result<(), DrawError> {
    let shown = |p: &&crate::results::SeriesPoint| frame.x.shows(p.x) && frame.y.shows(p.low);
    let points: Vec<_> = series.points.iter().filter(shown).collect();
    if points.len() < 2 || points.iter().all(|p| p.low == p.high) {
        return Ok(());
    }
    let upper = points.iter().map(|p| frame.at(p.x, p.high));
    let lower = points.iter().rev().map(|p| frame.at(p.x, p.low));
    let outline: Vec<(i32, i32)> = upper.chain(lower).map(|(x, y)| (canvas.px(x), canvas.px(y))).collect();
    canvas.area().draw(&Polygon::new(outline, color(name).mix(BAND)))?;
    Ok(())
}

/// The medians: a line, and a marker at each.
fn line<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    series: &Series,
    name: usize,
    frame: &Frame,
) -> Result<(), DrawError> {
    let shown = |p: &&crate::results::SeriesPoint| frame.x.shows(p.x) && frame.y.shows(p.median);
    let points: Vec<(i32, i32)> = series
        .points
        .iter()
        .filter(shown)
        .map(|p| frame.at(p.x, p.median))
        .map(|(x, y)| (canvas.px(x), canvas.px(y)))
        .collect();
    let [r, g, b] = mix(class_color(name), [255; 3], 0.1);
    let stroke = RGBColor(r, g, b).stroke_width(canvas.px(STROKE) as u32);
    canvas.area().draw(&PathElement::new(points.clone(), stroke))?;
    for point in points {
        draw_marker(canvas, name, point)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests;
