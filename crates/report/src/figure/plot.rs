//! Plots: a legend, then the plots, two in a row.

use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::drawing::{
    Area, Drawing, Drawn, GRID, Hover, INK, LABEL, NAME, NAME_MARGIN, PAGE_WIDTH, PALE_INK, PX, TITLE,
    anchored, bold, drop_of, line, px, rgb, text, text_width, upwards, write,
};
use crate::color::{Rgb, class_color, mix, value_range};
use crate::numbers::significant;
use crate::record::{AxisScale, Plot, PlotPoint, Series, SeriesKind, distinct};

/// The area inside the axes, and the distances around it.
const HEIGHT: f64 = 340.0;
const TITLE_HEIGHT: f64 = 36.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 14.0;
const UNDER: f64 = 60.0;
const PANEL: f64 = TITLE_HEIGHT + HEIGHT + UNDER;
/// Height of a line of the legend, and the space at its top.
const LEGEND_LINE: f64 = 28.0;
const LEGEND_TOP: f64 = 6.0;
/// Width of curves.
const STROKE: f64 = 2.0;
/// Opacity of bands.
const BAND: f64 = 0.16;
/// Half the size of a marker, and the width of its rim.
const RADIUS: f64 = 5.8;
const RIM: f64 = 1.4;

/// Width and height of the area inside the axes where two plots share a row, for ranges that fill it.
const MAP_SIZE: [f64; 2] = [PAGE_WIDTH as f64 / 2.0 - LEFT - RIGHT, HEIGHT];

/// Markers: a regular polygon by its number of corners, the direction of the first in degrees, and its radius, about one.
const MARKERS: [(u32, f64, f64); 5] =
    [(24, 0.0, 0.95), (3, 90.0, 1.25), (4, 45.0, 1.2), (4, 0.0, 1.25), (3, -90.0, 1.25)];

/// The marker of series number `n` around its point: the rim, and the face over it, as plotters strokes small outlines unevenly.
/// There are five markers and eight colors: the first 40 series differ in the pair, neighbors in both.
fn marker(n: usize, kind: SeriesKind) -> (Polygon<Pixels>, Polygon<Pixels>) {
    let color = class_color(n);
    let (rim, fill) = match kind {
        SeriesKind::Hollow => (color, [255; 3]),
        SeriesKind::Curve | SeriesKind::Filled => (mix(color, [0; 3], 0.5), color),
    };
    let (corners, first, long) = MARKERS[n % MARKERS.len()];
    let outline = |radius: f64, color: Rgb| {
        let corner = |i| {
            let (sin, cos) = (first + 360.0 * f64::from(i) / f64::from(corners)).to_radians().sin_cos();
            (px(cos * long * radius), -px(sin * long * radius))
        };
        Polygon::new((0..corners).map(corner).collect::<Vec<_>>(), rgb(color).filled())
    };
    (outline(RADIUS + RIM, rim), outline(RADIUS, fill))
}

/// The plots of a figure, and the names of their series, whose numbers decide the look.
pub(super) struct Plots<'a> {
    plots: &'a [Plot],
    names: Vec<&'a str>,
}

impl<'a> Plots<'a> {
    pub(super) fn new(plots: &'a [Plot]) -> Self {
        let series = plots.iter().flat_map(|plot| &plot.series);
        Self { plots, names: distinct(series.map(|series| series.name.as_str())) }
    }

    fn columns(&self) -> usize {
        self.plots.len().clamp(1, 2)
    }

    fn number(&self, series: &Series) -> usize {
        self.names.iter().position(|name| *name == series.name).unwrap_or(0)
    }

    /// One entry per name and kind of series, and the number of them in a line.
    fn legend(&self) -> (Vec<LegendEntry>, usize) {
        let mut entries: Vec<LegendEntry> = Vec::new();
        for series in self.plots.iter().flat_map(|plot| &plot.series) {
            let printed = if series.kind == SeriesKind::Hollow { ", paper" } else { "" };
            let entry = (format!("{}{printed}", series.name), self.number(series), series.kind);
            if !entries.contains(&entry) {
                entries.push(entry);
            }
        }
        let widest = entries.iter().map(|(name, ..)| name_width(name) + 64.0).fold(1.0, f64::max);
        let most = (f64::from(PAGE_WIDTH) / widest).max(1.0) as usize;
        let columns = entries.len().div_ceil(entries.len().div_ceil(most).max(1)).max(1);
        (entries, columns)
    }

    fn legend_height(&self) -> f64 {
        let (entries, columns) = self.legend();
        LEGEND_TOP + entries.len().div_ceil(columns) as f64 * LEGEND_LINE
    }
}

/// The name, number and kind of a series.
type LegendEntry = (String, usize, SeriesKind);

fn name_width(name: &str) -> f64 {
    text_width(name, &text(NAME, INK)) / f64::from(PX)
}

type Pixels = (i32, i32);

impl Drawing for Plots<'_> {
    fn size(&self) -> [i32; 2] {
        let rows = self.plots.len().div_ceil(self.columns()) as f64;
        [PAGE_WIDTH, (self.legend_height() + rows * PANEL) as i32 + 12]
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB, Vec<Hover>> {
        // A legend of plotters has one column inside the axes, where it covers data.
        let (entries, columns) = self.legend();
        let lines = entries.len().div_ceil(columns);
        let width = f64::from(PAGE_WIDTH) / columns as f64;
        for (i, (name, number, kind)) in entries.into_iter().enumerate() {
            let left = (i % columns) as f64 * width;
            let left = left + if lines > 1 { 20.0 } else { (width - 42.0 - name_width(&name)) / 2.0 };
            let middle = LEGEND_TOP + ((i / columns) as f64 + 0.5) * LEGEND_LINE;
            if kind == SeriesKind::Curve {
                line(area, [left, middle], [left + 32.0, middle], STROKE, class_color(number))?;
            }
            let (rim, face) = marker(number, kind);
            area.draw(&(EmptyElement::at((px(left + 16.0), px(middle))) + rim + face))?;
            write(area, &name, anchored(text(NAME, INK), HPos::Left), [left + 42.0, middle])?;
        }
        let column = f64::from(PAGE_WIDTH) / self.columns() as f64;
        let mut hovers = Vec::new();
        for (i, plot) in self.plots.iter().enumerate() {
            let (row, edge) = ((i / self.columns()) as f64, (i % self.columns()) as f64 * column);
            let top = self.legend_height() + row * PANEL;
            let panel = area.clone().shrink((px(edge), px(top)), (px(column), px(PANEL)));
            hovers.extend(self.draw_plot(plot, &panel, column)?);
        }
        Ok(hovers)
    }
}

impl Plots<'_> {
    fn draw_plot<DB: DrawingBackend>(
        &self,
        plot: &Plot,
        panel: &Area<DB>,
        width: f64,
    ) -> Drawn<DB, Vec<Hover>> {
        let [x, y] = &axes(plot);
        let middle = LEFT + (width - LEFT - RIGHT) / 2.0;
        write(panel, &plot.title, bold(text(TITLE, INK)), [middle, TITLE_HEIGHT / 2.0])?;
        let inside = [width - RIGHT - NAME_MARGIN, HEIGHT + UNDER].map(px);
        let inside = panel.clone().shrink((px(NAME_MARGIN), px(TITLE_HEIGHT)), inside.into());
        let mut chart = ChartBuilder::on(&inside)
            .x_label_area_size(px(UNDER))
            .y_label_area_size(px(LEFT - NAME_MARGIN))
            .build_cartesian_2d(x.clone(), y.clone())?;
        let label = text(LABEL, INK);
        let [x_label, y_label] = [x, y].map(|axis| move |tick: &f64| axis.format_ext(tick));
        let mut mesh = chart.configure_mesh();
        mesh.bold_line_style(rgb(GRID).stroke_width(PX as u32)).light_line_style(TRANSPARENT);
        mesh.axis_style(rgb(PALE_INK).stroke_width(PX as u32)).set_all_tick_mark_size(px(4.0));
        mesh.y_label_offset(drop_of(&label)).label_style(label).axis_desc_style(text(NAME, INK));
        mesh.x_label_formatter(&x_label).y_label_formatter(&y_label).x_desc(&x.name).y_desc(&y.name);
        if x.scale == AxisScale::Category {
            mesh.disable_x_mesh();
        }
        mesh.draw()?;
        let [low, high] = y.ends();
        let lines = plot.marks.iter().filter(|mark| x.scale != AxisScale::Category && is_shown(x, mark.x));
        for mark in lines {
            let stroke = rgb(INK).stroke_width(px(1.5) as u32);
            chart.draw_series([PathElement::new([(mark.x, low), (mark.x, high)], stroke)])?;
            let name = upwards(anchored(text(LABEL, INK), HPos::Right));
            let beside =
                EmptyElement::at((mark.x, high)) + Text::new(mark.name.clone(), (px(-8.0), px(8.0)), name);
            chart.draw_series([beside])?;
        }
        let own = Plots::new(std::slice::from_ref(plot));
        let mut hovers = Vec::new();
        // The first series covers the others, and bands are under all of them.
        for is_band in [true, false] {
            for series in plot.series.iter().rev() {
                let points = || series.points.iter().filter(|p| is_shown(x, p.x));
                let ranged = || points().filter(|p| is_shown(y, p.low) && is_shown(y, p.high));
                let number = self.number(series);
                let color = class_color(number);
                if is_band {
                    if series.kind == SeriesKind::Curve && ranged().any(|p| p.low < p.high) {
                        let upper = ranged().map(|p| (p.x, p.high));
                        let band: Vec<_> = upper.chain(ranged().rev().map(|p| (p.x, p.low))).collect();
                        chart.draw_series([Polygon::new(band, rgb(color).mix(BAND))])?;
                    }
                    continue;
                }
                let is_beside = x.scale == AxisScale::Category;
                let aside = if is_beside { beside(own.number(series), own.names.len()) } else { 0.0 };
                let stroke = rgb(mix(color, [255; 3], 0.1)).stroke_width(px(STROKE) as u32);
                let points = || points().filter(|p| is_shown(y, p.y));
                if series.kind == SeriesKind::Curve {
                    chart.draw_series(LineSeries::new(points().map(|p| (p.x, p.y)), stroke))?;
                } else {
                    let ranges = ranged().filter(|p| p.low < p.high);
                    let bar =
                        |p: &PlotPoint| ErrorBar::new_vertical(p.x + aside, p.low, p.y, p.high, stroke, 0);
                    chart.draw_series(ranges.map(bar))?;
                }
                let marked = |p: &PlotPoint| {
                    let (rim, face) = marker(number, series.kind);
                    EmptyElement::at((p.x + aside, p.y)) + rim + face
                };
                chart.draw_series(points().map(marked))?;
                hovers.extend(
                    points().map(|p| (chart.backend_coord(&(p.x + aside, p.y)), says(plot, series, p))),
                );
            }
        }
        Ok(hovers)
    }
}

/// What the page says of a point.
fn says(plot: &Plot, series: &Series, p: &PlotPoint) -> String {
    let written = |value: f64| significant(value, 4);
    let note = if p.note.is_empty() { String::new() } else { format!(", {}", p.note) };
    let range = match p.low < p.high {
        true => format!(" ({} to {})", written(p.low), written(p.high)),
        false => String::new(),
    };
    match plot.x.scale {
        AxisScale::Map => format!("{}{note}", series.name),
        AxisScale::Category => format!("{}: {}{range}{note}", series.name, written(p.y)),
        _ => format!("{}: {}{range} at {}{note}", series.name, written(p.y), written(p.x)),
    }
}

/// The axes of a plot, which hold all series and marks.
fn axes(plot: &Plot) -> [PlotAxis; 2] {
    let points = || plot.series.iter().flat_map(|series| &series.points);
    let x = match plot.x.scale {
        AxisScale::Map => return map_axes(plot),
        AxisScale::Category => {
            PlotAxis::categories(&plot.x.name, plot.marks.iter().map(|mark| mark.name.clone()))
        }
        _ => PlotAxis::holding(&plot.x, points().map(|p| p.x).chain(plot.marks.iter().map(|mark| mark.x))),
    };
    [x, PlotAxis::holding(&plot.y, points().flat_map(|p| [p.low, p.y, p.high]))]
}

/// Axes that show all points at one scale.
fn map_axes(plot: &Plot) -> [PlotAxis; 2] {
    let points: Vec<[f64; 2]> = plot.series.iter().flat_map(|s| &s.points).map(|p| [p.x, p.y]).collect();
    let ends = [0, 1].map(|i| {
        let values: Vec<f64> = points.iter().map(|p| p[i]).collect();
        value_range(&values).unwrap_or_default()
    });
    let per_unit = [0, 1].map(|i| (ends[i][1] - ends[i][0]) / MAP_SIZE[i]).into_iter().fold(0.0, f64::max);
    // All points in one place: any scale at which the ends of the range differ.
    let smallest = 1e-6 * ends.iter().flatten().fold(0.0_f64, |m, v| m.max(v.abs()));
    let per_unit = if per_unit > smallest { 1.14 * per_unit } else { smallest.max(1.0 / MAP_SIZE[0]) };
    [0, 1].map(|i| {
        let ([low, high], axis) = (ends[i], [&plot.x, &plot.y][i]);
        let (middle, half) = (low + (high - low) / 2.0, per_unit * MAP_SIZE[i] / 2.0);
        PlotAxis::linear(&axis.name, &axis.unit, [middle - half, middle + half])
    })
}

/// Where the `i`-th of `n` series stands beside the middle of a category.
fn beside(i: usize, n: usize) -> f64 {
    (i as f64 - (n as f64 - 1.0) / 2.0) * 0.7 / n as f64
}

fn is_shown(axis: &PlotAxis, value: f64) -> bool {
    axis.share(value).is_some()
}
