//! Matrices: one by itself, others two in a row.
//!
//! Cells are a picture, as 148 shapes have 22,000 of them; names, lines, counts and colour bars are drawn over it.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::drawing::{
    Area, Drawing, Drawn, GRID, Hover, INK, LABEL, NAME_MARGIN, PAGE_WIDTH, PAPER, PICTURE_PX, PX, Picture,
    TITLE, anchored, bar_labels, bold, line, px, text, text_width, upwards, write,
};
use crate::color::{Rgb, perceptual};
use crate::error::ReportError;
use crate::image::RgbaImage;
use crate::record::Heat;

/// White and ink over cells, in which dark pages keep them.
const ON_DARK: Rgb = [254; 3];
const ON_PALE: Rgb = [35; 3];
/// The colour of a count that is all of its row.
const FULL: Rgb = [31, 80, 154];
/// Height of a line of names, and the space between names and cells.
const LINE: f64 = 16.0;
const SPACE: f64 = 8.0;
/// The greatest side of a cell, and the least in which a count fits.
const CELL: f64 = 46.0;
const LEGIBLE: f64 = 18.0;
const TITLE_HEIGHT: f64 = 40.0;
/// To the right: a gap, the colour bar, its labels.
const GAP: f64 = 12.0;
const BAR: f64 = 14.0;
const BAR_LABELS: f64 = 70.0;

/// The matrices of a figure.
pub(super) struct Heats<'a>(pub(super) &'a [Heat]);

impl Heats<'_> {
    fn frames(&self) -> Vec<MatrixFrame<'_>> {
        let columns = self.0.len().clamp(1, 2);
        let room = f64::from(PAGE_WIDTH) / columns as f64;
        let mut frames: Vec<MatrixFrame<'_>> =
            self.0.iter().map(|heat| MatrixFrame::new(heat, room)).collect();
        let mut top = 0.0;
        for row in frames.chunks_mut(columns) {
            for (column, frame) in row.iter_mut().enumerate() {
                let taken = frame.names + frame.wide + frame.beside;
                frame.left = (column as f64 * room + frame.names + (room - taken) / 2.0).round();
                frame.top = top + TITLE_HEIGHT;
            }
            top += row.iter().map(|frame| TITLE_HEIGHT + frame.high + frame.below).fold(0.0, f64::max);
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

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB, Vec<Hover>> {
        self.frames().iter().try_for_each(|frame| frame.draw(area))?;
        Ok(Vec::new())
    }
}

/// A matrix and its place.
struct MatrixFrame<'a> {
    heat: &'a Heat,
    left: f64,
    top: f64,
    /// Side of a cell, and size of the matrix.
    cell: f64,
    wide: f64,
    high: f64,
    /// Room for names at the left and below, and for the colour bar.
    names: f64,
    below: f64,
    beside: f64,
    /// The value of the last colour; the first colour is that of zero.
    max: f64,
}

impl<'a> MatrixFrame<'a> {
    fn new(heat: &'a Heat, room: f64) -> Self {
        let [n_rows, n_columns] = [&heat.rows, &heat.columns].map(|names| names.len().max(1) as f64);
        let width = |name: &String| text_width(name, &text(LABEL, INK)) / f64::from(PX);
        let [names, below] =
            [&heat.rows, &heat.columns].map(|all| all.iter().map(width).fold(0.0, f64::max) + 2.0 * SPACE);
        let beside = if heat.quantity.is_some() { GAP + BAR + BAR_LABELS } else { 2.0 * SPACE };
        let cell = ((room - names - beside) / n_columns).clamp(1.0, CELL);
        let cell = if cell > LEGIBLE { cell.floor() } else { cell };
        let [wide, high] = [n_columns, n_rows].map(|n| (cell * n).floor());
        let max = heat.values.iter().flatten().fold(0.0_f64, |most, v| most.max(*v));
        Self { heat, left: 0.0, top: 0.0, cell, wide, high, names, below, beside, max }
    }

    /// The share of the greatest value, or of the counts of a row.
    fn share(&self, row: usize, column: usize) -> f64 {
        let values = &self.heat.values[row];
        let whole = if self.heat.quantity.is_some() { self.max } else { values.iter().sum() };
        if whole > 0.0 { values[column] / whole } else { 0.0 }
    }

    /// The pixel for a share. Counts cover the page as far as the share says.
    fn color(&self, share: f64) -> [u8; 4] {
        let is_count = self.heat.quantity.is_none();
        let ([r, g, b], alpha) = if is_count { (FULL, share) } else { (perceptual(share), 1.0) };
        [r, g, b, (255.0 * alpha).round() as u8]
    }

    /// The cells, and the colours of the bar.
    fn pictures(&self) -> Vec<Picture> {
        let Heat { rows, columns, quantity, .. } = self.heat;
        let [wide, high, thick] = [self.wide, self.high, BAR].map(|side| side as i32 * PICTURE_PX);
        let cell = |x: usize, y: usize| {
            self.color(self.share(y * rows.len() / high as usize, x * columns.len() / wide as usize))
        };
        let [left, top] = [self.left, self.top].map(|at| at as i32);
        let cells = (RgbaImage::from_fn(wide as u32, high as u32, cell), [left, top]);
        let shade = |_, row| self.color(1.0 - row as f64 / f64::from(high - 1));
        let shades = || RgbaImage::from_fn(thick as u32, high as u32, shade);
        let bar = quantity.iter().map(|_| (shades(), [(self.left + self.wide + GAP) as i32, top]));
        std::iter::once(cells).chain(bar).collect()
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let Self { heat, left, top, cell, wide, high, .. } = self;
        let title = bold(text(TITLE, INK));
        write(area, &heat.title, title, [left + wide / 2.0, top - TITLE_HEIGHT / 2.0])?;
        let label = anchored(text(LABEL, INK), HPos::Right);
        for (at, name) in self.named(&heat.rows) {
            write(area, name, label.clone(), [left - SPACE, top + at * cell])?;
        }
        for (at, name) in self.named(&heat.columns) {
            write(area, name, upwards(label.clone()), [left + at * cell, top + high + SPACE])?;
        }
        let (color, width) = if heat.quantity.is_some() { (PAPER, 1.5) } else { (GRID, 1.0) };
        for x in edges(&heat.columns).into_iter().map(|edge| left + edge as f64 * cell) {
            line(area, [x, *top], [x, top + high], width, color)?;
        }
        for y in edges(&heat.rows).into_iter().map(|edge| top + edge as f64 * cell) {
            line(area, [*left, y], [left + wide, y], width, color)?;
        }
        let Some(quantity) = &heat.quantity else { return self.draw_counts(area) };
        let corner = (px(left + wide + GAP), px(*top));
        let axis = PlotAxis::bar(
            &quantity.name,
            &quantity.unit,
            [0.0, if self.max > 0.0 { self.max } else { 1.0 }],
            7,
        );
        let place = area.clone().shrink(corner, (px(BAR + BAR_LABELS - NAME_MARGIN), px(*high)));
        bar_labels(&place, &axis, BAR, LABEL, PX)
    }

    fn draw_counts<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        for (row, counts) in self.heat.values.iter().enumerate().filter(|_| self.cell >= LEGIBLE) {
            for (column, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0.0) {
                let ink = if self.share(row, column) > 0.5 { ON_DARK } else { ON_PALE };
                let [x, y] = [column, row].map(|at| (at as f64 + 0.5) * self.cell);
                write(area, &count.to_string(), text(LABEL, ink), [self.left + x, self.top + y])?;
            }
        }
        Ok(())
    }

    /// The name and the middle of every group, without those that would touch the one before.
    fn named<'n>(&self, names: &'n [String]) -> Vec<(f64, &'n str)> {
        let groups = edges(names);
        let mut free = f64::NEG_INFINITY;
        let named = groups.windows(2).filter_map(|group| {
            let middle = (group[0] + group[1]) as f64 / 2.0;
            let fits = middle * self.cell >= free;
            free = if fits { middle * self.cell + LINE } else { free };
            fits.then(|| (middle, names[group[0]].as_str()))
        });
        named.collect()
    }
}

/// Where groups of equal names begin, and the end of the last one.
fn edges(names: &[String]) -> Vec<usize> {
    (0..=names.len()).filter(|&i| i == 0 || i == names.len() || names[i] != names[i - 1]).collect()
}
