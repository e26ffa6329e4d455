//! A confusion matrix with its counts.

use plotters::prelude::*;

use crate::results::Classification;
use view::canvas::{Anchor, Canvas, DrawError, Drawing, GRID, INK, SMALL, TEXT, Type, text_width};
use view::color::mix;

pub(super) struct ConfusionPlot<'a>(pub(super) &'a Classification);

/// Name of the last column.
const UNKNOWN: &str = "unknown";
/// Colour of a full cell.
const FULL: [u8; 3] = [31, 80, 154];
/// Cells are of this side, in units, unless there are too many.
const SIDE: f64 = 46.0;
const WIDTH: f64 = 1000.0;
const MARGIN: f64 = 16.0;
/// Below this side the counts would not fit.
const LEGIBLE: f64 = 18.0;

impl ConfusionPlot<'_> {
    fn columns(&self) -> Vec<&str> {
        self.0.classes.iter().map(String::as_str).chain([UNKNOWN]).collect()
    }

    /// Room for the longest name.
    fn names(&self) -> f64 {
        let width = |name: &&str| text_width(name, Type::new(SMALL, Anchor::Left));
        self.columns().iter().map(width).fold(0.0, f64::max) + 14.0
    }

    fn side(&self) -> f64 {
        let room = WIDTH - 2.0 * MARGIN - self.names() - 30.0;
        SIDE.min((room / self.columns().len() as f64).floor()).max(2.0)
    }
}

impl Drawing for ConfusionPlot<'_> {
    fn size(&self) -> (u32, u32) {
        let rows = self.0.classes.len() as f64 * self.side();
        (WIDTH as u32, (rows + self.names() + 3.0 * MARGIN + 30.0) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        let (side, names) = (self.side(), self.names());
        let columns = self.columns();
        let wide = side * columns.len() as f64;
        let high = side * self.0.classes.len() as f64;
        let left = (WIDTH - wide + names + 30.0) / 2.0;
        let top = MARGIN;
        for (i, row) in self.0.confusion.iter().enumerate() {
            let total = row.iter().sum::<usize>().max(1) as f64;
            let middle = top + (i as f64 + 0.5) * side;
            canvas.text(&self.0.classes[i], (left - 8.0, middle), Type::new(SMALL, Anchor::Right))?;
            for (j, &count) in row.iter().enumerate() {
                let share = count as f64 / total;
                let corner = (left + j as f64 * side, top + i as f64 * side);
                let [r, g, b] = mix([255; 3], FULL, share);
                let ends = [corner, (corner.0 + side, corner.1 + side)];
                let ends = ends.map(|(x, y)| (canvas.px(x), canvas.px(y)));
                canvas.area().draw(&Rectangle::new(ends, RGBColor(r, g, b).filled()))?;
                if count > 0 && side >= LEGIBLE {
                    let mut kind = Type::new(SMALL, Anchor::Center);
                    kind.color = if share > 0.5 { WHITE } else { INK };
                    canvas.text(&count.to_string(), (corner.0 + side / 2.0, middle), kind)?;
                }
            }
        }
        for line in 0..=self.0.classes.len() {
            let at = top + line as f64 * side;
            canvas.line((left, at), (left + wide, at), 1.0, GRID)?;
        }
        for (j, name) in columns.iter().enumerate() {
            let at = left + j as f64 * side;
            canvas.line((at, top), (at, top + high), 1.0, GRID)?;
            let below = (at + side / 2.0, top + high + 8.0);
            canvas.text(name, below, Type::new(SMALL, Anchor::Right).up())?;
        }
        canvas.line((left + wide, top), (left + wide, top + high), 1.0, GRID)?;
        let name = Type::new(TEXT, Anchor::Center);
        canvas.text("true class", (left - names - 16.0, top + high / 2.0), name.up())?;
        canvas.text("predicted class", (left + wide / 2.0, top + high + names + MARGIN), name)
    }
}
