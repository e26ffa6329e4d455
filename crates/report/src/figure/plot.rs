//! Static drawing of plots: a legend, then the plots, two in a row.

use super::model::{Plot, Point, Series, Shape};
use super::style::grown;
use crate::results::AxisScale;
use view::canvas::{Anchor, Canvas, GRID, INK, PAGE_WIDTH, PALE_INK, Point as Place, TextStyle, text_width};
use view::color::mix;

/// The area inside the axes, and the distances around it.
const HEIGHT: f64 = 340.0;
const TITLE_HEIGHT: f64 = 36.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 14.0;
const UNDER: f64 = 62.0;
/// Height of the scores under a plot.
const SCORES: f64 = 66.0;
const LEGEND: TextStyle = TextStyle::NAME.at(Anchor::Left);
const LEGEND_LINE: f64 = 28.0;
/// Width of curves.
const STROKE: f64 = 2.0;
/// Opacity of bands.
const BAND: f64 = 0.16;
/// Half the size of a marker, and the width of its dark rim.
const RADIUS: f64 = 5.8;
const RIM: f64 = 1.1;

/// Width and height of the area inside the axes where two plots share a row, for ranges that fill it.
pub const MAP_SIZE: [f64; 2] = [PAGE_WIDTH / 2.0 - LEFT - RIGHT, HEIGHT];

pub(super) fn draw(plots: &[Plot]) -> Canvas {
    let columns = plots.len().clamp(1, 2);
    let scores = if plots.iter().all(|plot| plot.scores.is_empty()) { 0.0 } else { SCORES };
    let panel = TITLE_HEIGHT + HEIGHT + UNDER + scores;
    let legend = legend_lines(plots);
    let rows = plots.len().div_ceil(columns) as f64;
    let height = legend.len() as f64 * LEGEND_LINE + rows * panel + 16.0;
    let mut canvas = Canvas::new(PAGE_WIDTH as u32, height as u32);
    let top = draw_legend(&mut canvas, &legend);
    let column = PAGE_WIDTH / columns as f64;
    for (i, plot) in plots.iter().enumerate() {
        let edge = (i % columns) as f64 * column;
        let top = top + (i / columns) as f64 * panel + TITLE_HEIGHT;
        let frame = Frame { plot, left: edge + LEFT, top, width: column - LEFT - RIGHT };
        frame.draw(&mut canvas);
        draw_scores(&mut canvas, &plot.scores, (edge, top + HEIGHT + UNDER), column);
    }
    canvas
}

/// From the left end of an entry of the legend to its text.
fn key_width(series: &Series) -> f64 {
    if series.shape == Shape::Curve { 42.0 } else { 30.0 }
}

/// The entries of each line of the legend, one per name and shape, with their widths.
fn legend_lines(plots: &[Plot]) -> Vec<Vec<(&Series, f64)>> {
    let mut lines: Vec<Vec<(&Series, f64)>> = Vec::new();
    let mut used = f64::INFINITY;
    for series in plots.iter().flat_map(|plot| &plot.series) {
        let is_same = |(other, _): &(&Series, f64)| other.name == series.name && other.shape == series.shape;
        if lines.iter().flatten().any(is_same) {
            continue;
        }
        let width = key_width(series) + 30.0 + text_width(&series.name, LEGEND);
        if used + width > PAGE_WIDTH - 40.0 {
            lines.push(Vec::new());
            used = 0.0;
        }
        used += width;
        lines.last_mut().into_iter().for_each(|line| line.push((series, width)));
    }
    lines
}

/// Draws the legend at the top and returns its lower end.
fn draw_legend(canvas: &mut Canvas, lines: &[Vec<(&Series, f64)>]) -> f64 {
    let mut top = 6.0;
    for line in lines {
        let width: f64 = line.iter().map(|(_, width)| width).sum();
        let mut left = (PAGE_WIDTH - width) / 2.0 + 12.0;
        for (series, width) in line {
            let middle = top + LEGEND_LINE / 2.0;
            if series.shape == Shape::Curve {
                canvas.line((left, middle), (left + 32.0, middle), STROKE, series.style.color());
            }
            marker(canvas, series, (left + 16.0, middle));
            canvas.text(&series.name, (left + key_width(series), middle), LEGEND);
            left += width;
        }
        top += LEGEND_LINE;
    }
    top
}

/// A plot and the area inside its axes.
struct Frame<'a> {
    plot: &'a Plot,
    left: f64,
    top: f64,
    width: f64,
}

impl Frame<'_> {
    /// The place of a point, unless it cannot be shown.
    fn at(&self, x: f64, y: f64) -> Option<Place> {
        let (x, y) = (self.plot.x.share(x)?, self.plot.y.share(y)?);
        Some((self.left + self.width * x, self.top + HEIGHT * (1.0 - y)))
    }

    fn draw(&self, canvas: &mut Canvas) {
        let middle = self.left + self.width / 2.0;
        canvas.text(&self.plot.title, (middle, self.top - TITLE_HEIGHT / 2.0), TextStyle::TITLE);
        self.axes(canvas);
        for series in self.plot.series.iter().rev().filter(|series| series.shape == Shape::Curve) {
            self.band(canvas, series);
        }
        for series in self.plot.series.iter().rev() {
            self.series(canvas, series);
        }
    }

    /// Grid, frame, tick labels, names of the axes, marks.
    fn axes(&self, canvas: &mut Canvas) {
        let Self { plot: Plot { x, y, marks, .. }, left, top, width } = *self;
        let (right, bottom) = (left + width, top + HEIGHT);
        for (share, label) in x.placed_ticks() {
            let at = left + width * share;
            if x.scale != AxisScale::Category {
                canvas.line((at, top), (at, bottom), 1.0, GRID);
            }
            canvas.text(label, (at, bottom + 15.0), TextStyle::LABEL);
        }
        for (share, label) in y.placed_ticks() {
            let at = bottom - HEIGHT * share;
            canvas.line((left, at), (right, at), 1.0, GRID);
            canvas.text(label, (left - 8.0, at), TextStyle::LABEL.at(Anchor::Right));
        }
        canvas.line((left, top), (left, bottom), 1.0, PALE_INK);
        canvas.line((left, bottom), (right, bottom), 1.0, PALE_INK);
        canvas.text(&x.name, ((left + right) / 2.0, bottom + 40.0), TextStyle::NAME);
        canvas.text(&y.name, (left - LEFT + 14.0, (top + bottom) / 2.0), TextStyle::NAME.up());
        for mark in marks {
            let Some(share) = x.share(mark.x) else { continue };
            let at = left + width * share;
            canvas.line((at, top), (at, bottom), 1.5, INK);
            let middle = top + 8.0 + text_width(&mark.name, TextStyle::LABEL) / 2.0;
            canvas.text(&mark.name, (at - 10.0, middle), TextStyle::LABEL.up());
        }
    }

    /// The ranges of a curve as a band.
    fn band(&self, canvas: &mut Canvas, series: &Series) {
        let ends = |p: &Point| Some((self.at(p.x, p.low)?, self.at(p.x, p.high)?, p.low < p.high));
        let ends: Vec<(Place, Place, bool)> = series.points.iter().filter_map(ends).collect();
        if ends.len() < 2 || ends.iter().all(|(.., is_range)| !is_range) {
            return;
        }
        let upper = ends.iter().map(|(_, high, _)| *high);
        let lower = ends.iter().rev().map(|(low, ..)| *low);
        canvas.polygon((0.0, 0.0), upper.chain(lower).collect(), series.style.color(), BAND);
    }

    /// A line, or error bars, and a marker at every point.
    fn series(&self, canvas: &mut Canvas, series: &Series) {
        let color = mix(series.style.color(), [255; 3], 0.1);
        let shown = || series.points.iter().filter_map(|p| Some((p, self.at(p.x, p.y)?)));
        if series.shape == Shape::Curve {
            canvas.path(shown().map(|(_, place)| place).collect(), STROKE, color);
        } else {
            for (p, _) in shown().filter(|(p, _)| p.low < p.high) {
                if let (Some(low), Some(high)) = (self.at(p.x, p.low), self.at(p.x, p.high)) {
                    canvas.line(low, high, STROKE, color);
                }
            }
        }
        shown().for_each(|(_, place)| marker(canvas, series, place));
    }
}

/// Writes scores as a small table in a column.
fn draw_scores(canvas: &mut Canvas, scores: &[(&str, String)], (left, top): Place, column: f64) {
    if scores.is_empty() {
        return;
    }
    let width = |(name, value): &(&str, String)| {
        text_width(name, TextStyle::LABEL).max(text_width(value, TextStyle::LABEL))
    };
    let widths: Vec<f64> = scores.iter().map(width).collect();
    let room = column - 16.0;
    let gap = (room - widths.iter().sum::<f64>()) / widths.len() as f64;
    let mut at = left + (column - room) / 2.0;
    for ((name, value), width) in scores.iter().zip(widths) {
        let middle = at + (width + gap) / 2.0;
        canvas.text(*name, (middle, top + 20.0), TextStyle::LABEL.colored(PALE_INK));
        canvas.text(value, (middle, top + 42.0), TextStyle::LABEL);
        at += width + gap;
    }
    for (y, color) in [(8.0, INK), (31.0, GRID), (54.0, INK)] {
        canvas.line((left + 10.0, top + y), (left + column - 10.0, top + y), 1.0, color);
    }
}

/// Draws the marker of a series around a point.
fn marker(canvas: &mut Canvas, Series { style, shape, .. }: &Series, center: Place) {
    let face: Vec<(f64, f64)> = style.outline().into_iter().map(|(x, y)| (x * RADIUS, y * RADIUS)).collect();
    let (rim, fill) = match shape {
        Shape::Hollow => (style.color(), [255; 3]),
        Shape::Curve | Shape::Filled => (mix(style.color(), [0; 3], 0.5), style.color()),
    };
    // Two filled polygons, the rim below the face: backends stroke small outlines unevenly.
    for (corners, color) in [(grown(&face, RIM), rim), (face, fill)] {
        canvas.polygon(center, corners.into_iter().map(|(x, y)| (x, -y)).collect(), color, 1.0);
    }
}
