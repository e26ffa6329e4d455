//! Plots: a legend, then the plots, two in a row.

use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::drawing::{
    Area, Drawing, Drawn, GRID, INK, LABEL, NAME, NAME_MARGIN, PAGE_WIDTH, PALE_INK, PX, Picture, TITLE,
    anchored, bold, drop_of, line, px, rgb, text, text_width, upwards, write,
};
use super::model::{Plot, PlotPoint, PlotSeries, SeriesKind};
use crate::color::{Rgb, mix};
use crate::error::ReportError;
use crate::results::AxisScale;

/// The area inside the axes, and the distances around it.
const HEIGHT: f64 = 340.0;
const TITLE_HEIGHT: f64 = 36.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 14.0;
const UNDER: f64 = 60.0;
/// Height of the scores under a plot.
const SCORES: f64 = 72.0;
/// Type size of scores.
const SCORE: f64 = 13.0;
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
pub const MAP_SIZE: [f64; 2] = [PAGE_WIDTH as f64 / 2.0 - LEFT - RIGHT, HEIGHT];

/// The plots of a figure.
pub(super) struct Plots<'a>(pub(super) &'a [Plot]);

impl Plots<'_> {
    fn columns(&self) -> usize {
        self.0.len().clamp(1, 2)
    }

    fn panel_height(&self) -> f64 {
        let scores = if self.0.iter().all(|plot| plot.scores.is_empty()) { 0.0 } else { SCORES };
        TITLE_HEIGHT + HEIGHT + UNDER + scores
    }

    /// One entry per name and kind of series, and the number of them in a line.
    fn legend(&self) -> (Vec<&PlotSeries>, usize) {
        let mut entries: Vec<&PlotSeries> = Vec::new();
        for series in self.0.iter().flat_map(|plot| &plot.series) {
            if !entries.iter().any(|known| known.name == series.name && known.kind == series.kind) {
                entries.push(series);
            }
        }
        let style = text(NAME, INK);
        let width = |series: &&PlotSeries| text_width(&series.name, &style) / f64::from(PX) + 64.0;
        let widest = entries.iter().map(width).fold(1.0, f64::max);
        let most = (f64::from(PAGE_WIDTH) / widest).max(1.0) as usize;
        let columns = entries.len().div_ceil(entries.len().div_ceil(most).max(1)).max(1);
        (entries, columns)
    }

    fn legend_height(&self) -> f64 {
        let (entries, columns) = self.legend();
        LEGEND_TOP + entries.len().div_ceil(columns) as f64 * LEGEND_LINE
    }
}

impl Drawing for Plots<'_> {
    fn size(&self) -> [i32; 2] {
        let rows = self.0.len().div_ceil(self.columns()) as f64;
        [PAGE_WIDTH, (self.legend_height() + rows * self.panel_height()) as i32 + 12]
    }

    fn pictures(&self) -> Result<Vec<Picture>, ReportError> {
        Ok(vec![])
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        // A legend of plotters has one column inside the axes, where it covers data.
        let (entries, columns) = self.legend();
        let (_, legend) = area.margin(px(LEGEND_TOP), 0, 0, 0).split_vertically(0);
        let lines = entries.len().div_ceil(columns);
        let width = f64::from(PAGE_WIDTH) / columns as f64;
        for (i, series) in entries.into_iter().enumerate() {
            let left = (i % columns) as f64 * width;
            let used = 42.0 + text_width(&series.name, &text(NAME, INK)) / f64::from(PX);
            let left = if lines > 1 { left + 20.0 } else { left + (width - used) / 2.0 };
            entry(&legend, series, [left, (i / columns) as f64 * LEGEND_LINE + LEGEND_LINE / 2.0])?;
        }
        let column = f64::from(PAGE_WIDTH) / self.columns() as f64;
        for (i, plot) in self.0.iter().enumerate() {
            let (row, edge) = ((i / self.columns()) as f64, (i % self.columns()) as f64 * column);
            let top = self.legend_height() + row * self.panel_height();
            let panel = area.clone().shrink((px(edge), px(top)), (px(column), px(self.panel_height())));
            draw_plot(plot, &panel, column)?;
            draw_scores(&plot.scores, &panel, column)?;
        }
        Ok(())
    }
}

/// An entry of the legend.
fn entry<DB: DrawingBackend>(area: &Area<DB>, series: &PlotSeries, [left, middle]: [f64; 2]) -> Drawn<DB> {
    if series.kind == SeriesKind::Curve {
        line(area, [left, middle], [left + 32.0, middle], STROKE, series.style.color())?;
    }
    let (rim, face) = marker(series);
    let place = (px(left + 16.0), px(middle));
    area.draw(&(EmptyElement::at(place) + rim + face))?;
    write(area, &series.name, anchored(text(NAME, INK), HPos::Left), [left + 42.0, middle])
}

type Pixels = (i32, i32);

/// The marker of a series around its point: the rim, and the face over it, as plotters strokes small outlines unevenly.
fn marker(series: &PlotSeries) -> (Polygon<Pixels>, Polygon<Pixels>) {
    let color = series.style.color();
    let (rim, fill) = match series.kind {
        SeriesKind::Hollow => (color, [255; 3]),
        SeriesKind::Curve | SeriesKind::Filled => (mix(color, [0; 3], 0.5), color),
    };
    let outline = |radius: f64, color: Rgb| {
        let corners = series.style.outline().map(|[x, y]| (px(x * radius), -px(y * radius)));
        Polygon::new(corners.collect::<Vec<_>>(), rgb(color).filled())
    };
    (outline(RADIUS + RIM, rim), outline(RADIUS, fill))
}

fn draw_plot<DB: DrawingBackend>(plot: &Plot, panel: &Area<DB>, width: f64) -> Drawn<DB> {
    let Plot { title, x, y, series, marks, .. } = plot;
    let middle = LEFT + (width - LEFT - RIGHT) / 2.0;
    write(panel, title, bold(text(TITLE, INK)), [middle, TITLE_HEIGHT / 2.0])?;
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
    let shown = |at: &PlotPoint, value: f64| is_shown(x, at.x) && is_shown(y, value);
    let [low, high] = y.ends();
    for mark in marks.iter().filter(|mark| is_shown(x, mark.x)) {
        let stroke = rgb(INK).stroke_width(px(1.5) as u32);
        chart.draw_series([PathElement::new([(mark.x, low), (mark.x, high)], stroke)])?;
        let name = upwards(anchored(text(LABEL, INK), HPos::Right));
        let beside =
            EmptyElement::at((mark.x, high)) + Text::new(mark.name.clone(), (px(-8.0), px(8.0)), name);
        chart.draw_series([beside])?;
    }
    // The first series covers the others.
    for one in series.iter().rev().filter(|one| one.kind == SeriesKind::Curve) {
        let ranges = || one.points.iter().filter(|p| shown(p, p.low) && shown(p, p.high));
        if ranges().any(|p| p.low < p.high) {
            let upper = ranges().map(|p| (p.x, p.high));
            let band: Vec<(f64, f64)> = upper.chain(ranges().rev().map(|p| (p.x, p.low))).collect();
            chart.draw_series([Polygon::new(band, rgb(one.style.color()).mix(BAND))])?;
        }
    }
    for one in series.iter().rev() {
        let stroke = rgb(mix(one.style.color(), [255; 3], 0.1)).stroke_width(px(STROKE) as u32);
        let points = || one.points.iter().filter(|p| shown(p, p.y));
        if one.kind == SeriesKind::Curve {
            chart.draw_series(LineSeries::new(points().map(|p| (p.x, p.y)), stroke))?;
        } else {
            let ranges = points().filter(|p| p.low < p.high && shown(p, p.low) && shown(p, p.high));
            chart.draw_series(ranges.map(|p| ErrorBar::new_vertical(p.x, p.low, p.y, p.high, stroke, 0)))?;
        }
        let marked = |p: &PlotPoint| {
            let (rim, face) = marker(one);
            EmptyElement::at((p.x, p.y)) + rim + face
        };
        chart.draw_series(points().map(marked))?;
    }
    Ok(())
}

fn is_shown(axis: &PlotAxis, value: f64) -> bool {
    axis.share(value).is_some()
}

/// Writes scores as a small table at the foot of a panel.
fn draw_scores<DB: DrawingBackend>(scores: &[(&str, String)], panel: &Area<DB>, width: f64) -> Drawn<DB> {
    if scores.is_empty() {
        return Ok(());
    }
    let top = TITLE_HEIGHT + HEIGHT + UNDER;
    let pale = text(SCORE, PALE_INK);
    let lengths = scores.iter().map(|(name, _)| text_width(name, &pale) / f64::from(PX));
    let lengths: Vec<f64> = lengths.map(|length| length.max(44.0)).collect();
    let gap = (width - 20.0 - lengths.iter().sum::<f64>()) / lengths.len() as f64;
    let mut left = 10.0;
    for ((name, value), length) in scores.iter().zip(lengths) {
        let middle = left + (length + gap) / 2.0;
        write(panel, name, pale.clone(), [middle, top + 20.0])?;
        write(panel, value, text(SCORE, INK), [middle, top + 43.0])?;
        left += length + gap;
    }
    for (down, color) in [(8.0, INK), (31.0, GRID), (55.0, INK)] {
        line(panel, [10.0, top + down], [width - 10.0, top + down], 1.0, color)?;
    }
    Ok(())
}
