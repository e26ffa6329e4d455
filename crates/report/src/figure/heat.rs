//! Matrices: one by itself, others two in a row.
//!
//! Cells are a picture, as 148 shapes have 22,000 of them; names, lines and color bars are drawn over it.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::axis::PlotAxis;
use super::drawing::{
    Area, Drawing, Drawn, Hover, INK, LABEL, NAME_MARGIN, PAGE_WIDTH, PAPER, PICTURE_PX, PX, Picture, TITLE,
    anchored, bar_labels, bold, line, px, text, text_width, upwards, write,
};
use crate::color::perceptual;
use crate::error::ReportError;
use crate::image::RgbaImage;
use crate::record::Heat;

/// Height of a line of names, and the space between names and cells.
const LINE: f64 = 16.0;
const SPACE: f64 = 8.0;
/// The greatest side of a cell, and the least that is a whole number.
const CELL: f64 = 46.0;
const WHOLE: f64 = 18.0;
const TITLE_HEIGHT: f64 = 40.0;
/// To the right: a gap, the color bar, its labels.
const GAP: f64 = 12.0;
const BAR: f64 = 14.0;
const BAR_LABELS: f64 = 70.0;
const BESIDE: f64 = GAP + BAR + BAR_LABELS;

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
                let taken = frame.names + frame.side + BESIDE;
                frame.left = (column as f64 * room + frame.names + (room - taken) / 2.0).round();
                frame.top = top + TITLE_HEIGHT;
            }
            top += row.iter().map(|frame| TITLE_HEIGHT + frame.side + frame.names).fold(0.0, f64::max);
        }
        frames
    }
}

impl Drawing for Heats<'_> {
    fn size(&self) -> [i32; 2] {
        let bottom = |frame: &MatrixFrame<'_>| frame.top + frame.side + frame.names;
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
    /// Sides of a cell and of the matrix.
    cell: f64,
    side: f64,
    /// Room for names at the left and below.
    names: f64,
    /// The value of the last color; the first color is that of zero.
    max: f64,
}

impl<'a> MatrixFrame<'a> {
    fn new(heat: &'a Heat, room: f64) -> Self {
        let n = heat.names.len().max(1) as f64;
        let width = |name: &String| text_width(name, &text(LABEL, INK)) / f64::from(PX);
        let names = heat.names.iter().map(width).fold(0.0, f64::max) + 2.0 * SPACE;
        let cell = ((room - names - BESIDE) / n).clamp(1.0, CELL);
        let cell = if cell > WHOLE { cell.floor() } else { cell };
        let max = heat.values.iter().flatten().fold(0.0_f64, |most, v| most.max(*v));
        Self { heat, left: 0.0, top: 0.0, cell, side: (cell * n).floor(), names, max }
    }

    /// The cells, and the colors of the bar.
    fn pictures(&self) -> [Picture; 2] {
        let Heat { names, values, .. } = self.heat;
        let [side, thick] = [self.side, BAR].map(|side| side as i32 * PICTURE_PX);
        let color = |share: f64| {
            let [r, g, b] = perceptual(share);
            [r, g, b, 255]
        };
        let cell = |x: usize, y: usize| {
            let [column, row] = [x, y].map(|at| at * names.len() / side as usize);
            color(if self.max > 0.0 { values[row][column] / self.max } else { 0.0 })
        };
        let shade = |_, row| color(1.0 - row as f64 / f64::from(side - 1));
        let [left, top, bar] = [self.left, self.top, self.left + self.side + GAP].map(|at| at as i32);
        [
            (RgbaImage::from_fn(side as u32, side as u32, cell), [left, top]),
            (RgbaImage::from_fn(thick as u32, side as u32, shade), [bar, top]),
        ]
    }

    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB> {
        let Self { heat, left, top, cell, side, .. } = self;
        let title = bold(text(TITLE, INK));
        write(area, &heat.title, title, [left + side / 2.0, top - TITLE_HEIGHT / 2.0])?;
        let label = anchored(text(LABEL, INK), HPos::Right);
        for (at, name) in self.named() {
            write(area, name, label.clone(), [left - SPACE, top + at * cell])?;
            write(area, name, upwards(label.clone()), [left + at * cell, top + side + SPACE])?;
        }
        for edge in edges(&heat.names).into_iter().map(|edge| edge as f64 * cell) {
            line(area, [left + edge, *top], [left + edge, top + side], 1.5, PAPER)?;
            line(area, [*left, top + edge], [left + side, top + edge], 1.5, PAPER)?;
        }
        let corner = (px(left + side + GAP), px(*top));
        let most = if self.max > 0.0 { self.max } else { 1.0 };
        let axis = PlotAxis::bar(&heat.quantity.name, &heat.quantity.unit, [0.0, most], 7);
        let place = area.clone().shrink(corner, (px(BAR + BAR_LABELS - NAME_MARGIN), px(*side)));
        bar_labels(&place, &axis, BAR, LABEL, PX)
    }

    /// The name and the middle of every group, without those that would touch the one before.
    fn named(&self) -> Vec<(f64, &str)> {
        let names = &self.heat.names;
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
