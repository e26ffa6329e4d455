//! Matrices: one with counts by itself, others two in a row with colour bars.
//!
//! Cells are a picture, as 148 shapes have 22,000 of them; axes, lines, counts and colour bars are drawn over it.

use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::drawing::{
    Area, Drawing, Drawn, GRID, INK, LABEL, NAME, NAME_MARGIN, PAGE_WIDTH, PAPER, PICTURE_PX, PX, Picture,
    TITLE, anchored, bold, drop_of, px, rgb, scaled_text, text, text_width, upwards, write,
};
use super::model::Heat;
use crate::color::{Rgb, perceptual};
use crate::error::ReportError;
use crate::image::RgbaImage;

/// White and ink over cells, in which dark pages keep them.
const ON_DARK: Rgb = [254; 3];
const ON_PALE: Rgb = [35; 3];
/// Height of a line of names.
const LINE: f64 = 16.0;
/// The greatest side of a cell with a count, and the least in which a count fits.
const CELL: f64 = 46.0;
const LEGIBLE: f64 = 18.0;
/// Side of a matrix with a colour bar, and the room for its names.
const SIDE: f64 = 310.0;
const LEFT: f64 = 92.0;
const TITLE_HEIGHT: f64 = 40.0;
/// To the right of it: a gap, the colour bar, its labels.
const GAP: f64 = 12.0;
const BAR: f64 = 14.0;
const BAR_LABELS: f64 = 70.0;
/// Characters of a name that fit into [`LEFT`], about.
const LONGEST: usize = 10;

/// The matrices of a figure.
pub(super) struct Heats<'a>(pub(super) &'a [Heat]);

impl Heats<'_> {
    fn frames(&self) -> Vec<MatrixFrame<'_>> {
        let columns = self.0.len().clamp(1, 2);
        let mut frames: Vec<MatrixFrame<'_>> = self.0.iter().map(MatrixFrame::new).collect();
        let below = frames.iter().map(|frame| frame.below).fold(0.0, f64::max);
        let column = f64::from(PAGE_WIDTH) / columns as f64;
        for (i, frame) in frames.iter_mut().enumerate() {
            let room = if frame.heat.bar.is_some() { GAP + BAR + BAR_LABELS } else { 0.0 };
            let before = (column - frame.wide - frame.names - room).max(0.0) / 2.0;
            frame.left =
                (i % columns) as f64 * column + frame.names + if columns == 1 { before } else { 0.0 };
            let title = if frame.heat.title.is_empty() { LINE } else { TITLE_HEIGHT };
            frame.top = (i / columns) as f64 * (title + frame.high + below) + title;
            (frame.left, frame.top, frame.below) = (frame.left.round(), frame.top.round(), below);
        }
        frames
    }
}

impl Drawing for Heats<'_> {
    fn size(&self) -> [i32; 2] {
        let bottom = |frame: &MatrixFrame<'_>| frame.top + frame.high + frame.below;
        [PAGE_WIDTH, self.frames().iter().map(bottom).fold(0.0, f64::max) as i32 + 8]
    }

    fn pictures(&self) -> Result<Vec<Picture>, ReportError> {
        Ok(self.frames().iter().flat_map(MatrixFrame::pictures).collect())
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        self.frames().iter().try_for_each(|frame| frame.draw(area))
    }
}

/// A matrix and its place.
struct MatrixFrame<'a> {
    heat: &'a Heat,
    left: f64,
    top: f64,
    wide: f64,
    high: f64,
    /// Room for names at the left and below, with the names of the axes.
    names: f64,
    below: f64,
    /// The axes with shortened names. Names that would touch the one before are left out.
    x: PlotAxis,
    y: PlotAxis,
    /// Whether the names of columns fit side by side.
    is_level: bool,
}

impl<'a> MatrixFrame<'a> {
    fn new(heat: &'a Heat) -> Self {
        let (n_rows, n_columns) = (heat.rows.len() as f64, heat.columns.len() as f64);
        let [mut x, mut y] = [heat.x.clone(), heat.y.clone()];
        let width = |name: &str| text_width(name, &text(LABEL, INK)) / f64::from(PX);
        let widest = |axis: &PlotAxis| axis.ticks.iter().map(|(_, name)| width(name)).fold(0.0, f64::max);
        let (names, [wide, high]) = match heat.counts {
            Some(_) => {
                let names = widest(&y).max(widest(&x)) + 44.0;
                let cell = CELL.min(((f64::from(PAGE_WIDTH) - names - 32.0) / n_columns).floor()).max(2.0);
                (names, [n_columns, n_rows].map(|n| cell * n))
            }
            None => {
                let ticks = x.ticks.iter_mut().chain(&mut y.ticks);
                ticks.for_each(|(_, name)| *name = shortened(name));
                (LEFT, [SIDE; 2])
            }
        };
        let [column, row] = [wide / n_columns, high / n_rows];
        let room = |t: &[(f64, String)]| (width(&t[0].1) + width(&t[1].1)) / 2.0 + 8.0;
        let is_level = x.ticks.windows(2).all(|t| (t[1].0 - t[0].0) * column > room(t));
        let below = if is_level { 24.0 } else { 16.0 + widest(&x) };
        let below = below + if x.name.is_empty() { 10.0 } else { 30.0 };
        y.ticks = thinned(&y, row);
        if !is_level {
            x.ticks = thinned(&x, column);
        }
        Self { heat, left: 0.0, top: 0.0, wide, high, names, below, x, y, is_level }
    }

    fn share(&self, row: usize, column: usize) -> f64 {
        if self.heat.max > 0.0 { self.heat.values[row][column] / self.heat.max } else { 0.0 }
    }

    /// The cells, and the colours of the bar.
    fn pictures(&self) -> Vec<Picture> {
        let Heat { rows, columns, tint, bar, .. } = self.heat;
        let [wide, high, thick] = [self.wide, self.high, BAR].map(|side| side as i32 * PICTURE_PX);
        let cell = |x: usize, y: usize| {
            color(*tint, self.share(y * rows.len() / high as usize, x * columns.len() / wide as usize))
        };
        let [left, top] = [self.left, self.top].map(|at| at as i32);
        let cells = (RgbaImage::from_fn(wide as u32, high as u32, cell), [left, top]);
        let shade = |_, row| color(*tint, 1.0 - row as f64 / f64::from(high - 1));
        let shades = || RgbaImage::from_fn(thick as u32, high as u32, shade);
        let bar = bar.iter().map(|_| (shades(), [(self.left + self.wide + GAP) as i32, top]));
        std::iter::once(cells).chain(bar).collect()
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let Self { heat, left, top, wide, high, names, below, x, y, is_level } = self;
        let title = bold(text(TITLE, INK));
        write(area, &heat.title, title, [left + wide / 2.0, top - TITLE_HEIGHT / 2.0])?;
        let corner = (px(left - names), px(*top));
        let panel = area.clone().shrink(corner, (px(names + wide), px(high + below)));
        let across = PlotAxis { ticks: if *is_level { x.ticks.clone() } else { vec![] }, ..x.clone() };
        let mut chart = ChartBuilder::on(&panel)
            .x_label_area_size(px(*below))
            .y_label_area_size(px(*names))
            .build_cartesian_2d(across.clone(), y.clone())?;
        let [x_label, y_label] = [&across, y].map(|axis| move |tick: &f64| axis.format_ext(tick));
        let label = text(LABEL, INK);
        let mut mesh = chart.configure_mesh();
        mesh.disable_mesh().axis_style(TRANSPARENT).set_all_tick_mark_size(px(4.0));
        mesh.y_label_offset(drop_of(&label)).label_style(label).axis_desc_style(text(NAME, INK));
        mesh.x_label_formatter(&x_label).y_label_formatter(&y_label).x_desc(&x.name).y_desc(&y.name);
        mesh.draw()?;
        if !is_level {
            // plotters centres the names under an axis, also those that run upwards.
            for (tick, name) in &x.ticks {
                let place = [left + (tick + 0.5) * wide / heat.columns.len() as f64, top + high + 8.0];
                write(area, name, upwards(anchored(text(LABEL, INK), HPos::Right)), place)?;
            }
        }
        let (n_rows, n_columns) = (heat.rows.len(), heat.columns.len());
        let ends = [n_columns, n_rows].map(|n| n as f64 - 0.5);
        let stroke = |color, width| rgb(color).stroke_width(px(width) as u32);
        let (stroke, lines) = match &heat.counts {
            Some(_) => (stroke(GRID, 1.0), [(0..=n_columns).collect(), (0..=n_rows).collect()]),
            None => (stroke(PAPER, 1.5), [heat.borders.clone(), heat.borders.clone()]),
        };
        let [down, across] = lines.map(|at: Vec<usize>| at.into_iter().map(|at| at as f64 - 0.5));
        chart.draw_series(down.map(|x| PathElement::new([(x, -0.5), (x, ends[1])], stroke)))?;
        chart.draw_series(across.map(|y| PathElement::new([(-0.5, y), (ends[0], y)], stroke)))?;
        let cell = wide / n_columns as f64;
        for (row, own) in heat.counts.iter().flatten().enumerate().filter(|_| cell >= LEGIBLE) {
            for (column, count) in own.iter().enumerate().filter(|(_, count)| **count > 0) {
                let ink = if self.share(row, column) > 0.5 { ON_DARK } else { ON_PALE };
                let at = [left + (column as f64 + 0.5) * cell, top + (row as f64 + 0.5) * cell];
                write(area, &count.to_string(), text(LABEL, ink), at)?;
            }
        }
        let Some(bar) = &heat.bar else { return Ok(()) };
        let corner = (px(left + wide + GAP), px(*top));
        bar_labels(
            &area.clone().shrink(corner, (px(BAR + BAR_LABELS - NAME_MARGIN), px(*high))),
            bar,
            BAR,
            LABEL,
            PX,
        )
    }
}

/// Draws the ticks and the name of a colour bar of this thickness at the left of an area, with `scale` pixels per unit.
pub(crate) fn bar_labels<DB: DrawingBackend>(
    area: &Area<DB>,
    axis: &PlotAxis,
    thickness: f64,
    size: f64,
    scale: i32,
) -> Drawn<DB> {
    let label = scaled_text(size, INK, scale);
    let thickness = (thickness * f64::from(scale)) as u32;
    let (width, _) = area.dim_in_pixel();
    let mut chart = ChartBuilder::on(area)
        .right_y_label_area_size(width.saturating_sub(thickness))
        .build_cartesian_2d(0.0..1.0, axis.clone())?;
    let format = |tick: &f64| axis.format_ext(tick);
    let mut mesh = chart.configure_mesh();
    mesh.disable_mesh().axis_style(rgb(INK).stroke_width(scale.max(1) as u32));
    mesh.set_all_tick_mark_size((0.3 * size * f64::from(scale)) as i32).y_label_offset(drop_of(&label));
    mesh.label_style(label.clone()).axis_desc_style(label).y_label_formatter(&format).y_desc(&axis.name);
    mesh.draw()
}

/// The ticks whose names do not touch the one before, along an axis with cells of this size.
fn thinned(axis: &PlotAxis, cell: f64) -> Vec<(f64, String)> {
    let mut free = f64::NEG_INFINITY;
    let mut is_free = |tick: &&(f64, String)| {
        let fits = tick.0 * cell >= free;
        if fits {
            free = tick.0 * cell + LINE;
        }
        fits
    };
    axis.ticks.iter().filter(|tick| is_free(tick)).cloned().collect()
}

/// The pixel for a share of the greatest value. A tint covers the page as far as the share says.
fn color(tint: Option<Rgb>, share: f64) -> [u8; 4] {
    let ([r, g, b], alpha) = tint.map_or_else(|| (perceptual(share), 1.0), |full| (full, share));
    [r, g, b, (255.0 * alpha).round() as u8]
}

/// A name that fits to the left of a matrix with a colour bar.
fn shortened(name: &str) -> String {
    match name.char_indices().nth(LONGEST) {
        Some((end, _)) if name.chars().count() > LONGEST + 1 => format!("{}…", &name[..end]),
        _ => name.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_cut_between_letters() {
        assert_eq!(shortened("cat"), "cat");
        assert_eq!(shortened("elevenchars"), "elevenchars");
        assert_eq!(shortened("höchst unübersichtlich"), "höchst unü…");
    }
}
