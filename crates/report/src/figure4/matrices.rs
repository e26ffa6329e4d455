//! Distance matrices as heat maps, rows and columns grouped by class.

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

use super::{COLUMN, WIDTH, corner, rows, title};
use crate::classes::Classes;
use crate::results::Figure4Panel;
use view::RgbaImage;
use view::canvas::{Anchor, Canvas, DrawError, Drawing, PALE_INK, RASTER, SMALL, TEXT, Type, text_width};
use view::color::perceptual;
use view::numbers::Numbers;

/// The matrices of one scale.
pub(super) struct Matrices<'a> {
    panels: Vec<&'a Figure4Panel>,
    /// Shapes in the order they are drawn in: class by class.
    order: Vec<usize>,
    /// Class name, first row and row past the last of each class.
    groups: Vec<(String, usize, usize)>,
}

/// A panel, in units.
const TITLE_HEIGHT: f64 = 40.0;
const SIDE: f64 = 310.0;
/// Left of the matrix: class names.
const LEFT: f64 = 92.0;
/// Right of it: gap, colour bar, ticks, unit.
const GAP: f64 = 12.0;
const BAR: f64 = 14.0;
/// Characters of a class name; about as many fit into `LEFT`.
const NAME: usize = 10;
/// Type of class names, and height of a line of them.
const NAMES: Type = Type::new(SMALL, Anchor::Center);
const LINE: f64 = 16.0;

impl<'a> Matrices<'a> {
    pub(super) fn new(panels: Vec<&'a Figure4Panel>, labels: &[String], classes: &Classes) -> Self {
        let mut order: Vec<usize> = (0..labels.len()).collect();
        order.sort_by_key(|&shape| classes.index(&labels[shape]));
        let first = |class: usize| order.partition_point(|&shape| classes.index(&labels[shape]) < class);
        let groups =
            (0..classes.len()).map(|c| (shortened(classes.name(c)), first(c), first(c + 1))).collect();
        Self { panels, order, groups }
    }

    /// Units that the class names under the matrix take.
    fn foot(&self) -> f64 {
        if self.level_names() { 34.0 } else { 24.0 + self.longest_name() }
    }

    fn longest_name(&self) -> f64 {
        self.groups.iter().map(|g| text_width(&g.0, NAMES)).fold(0.0, f64::max)
    }

    /// Whether the names can be written level under their classes without touching.
    fn level_names(&self) -> bool {
        let cell = SIDE / self.order.len() as f64;
        let middle = |(_, first, end): &(String, usize, usize)| cell * (first + end) as f64 / 2.0;
        let half = |group: &(String, usize, usize)| text_width(&group.0, NAMES) / 2.0 + 4.0;
        self.groups.windows(2).all(|g| middle(&g[1]) - middle(&g[0]) > half(&g[0]) + half(&g[1]))
    }

    fn panel_height(&self) -> f64 {
        TITLE_HEIGHT + SIDE + self.foot()
    }
}

impl Drawing for Matrices<'_> {
    fn size(&self) -> (u32, u32) {
        (WIDTH as u32, (rows(self.panels.len()) * self.panel_height() + 4.0) as u32)
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        for (i, panel) in self.panels.iter().enumerate() {
            let (left, top) = corner(i, 4.0, self.panel_height());
            title(canvas, panel, (left + LEFT + SIDE / 2.0, top + TITLE_HEIGHT / 2.0))?;
            let corner = (left + LEFT, top + TITLE_HEIGHT);
            // The diagonal is zero, so is the scale's origin: equal colours are equal distances.
            let largest = panel.matrix.iter().flatten().fold(0.0_f64, |m, &v| m.max(v));
            canvas.image(&self.heat_map(panel, largest), corner)?;
            self.boundaries(canvas, corner)?;
            self.names(canvas, corner)?;
            color_bar(canvas, (corner.0 + SIDE + GAP, corner.1), largest, panel.scale.unit())?;
        }
        Ok(())
    }
}

impl Matrices<'_> {
    fn heat_map(&self, panel: &Figure4Panel, largest: f64) -> RgbaImage {
        let side = SIDE as u32 * RASTER;
        let mut image = RgbaImage::new(side, side, [255; 4]);
        let shape = |pixel: usize| self.order[pixel * self.order.len() / side as usize];
        for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
            let distance = panel.matrix[shape(i / side as usize)][shape(i % side as usize)];
            let [r, g, b] = perceptual(if largest > 0.0 { distance / largest } else { 0.0 });
            *pixel = [r, g, b, 255];
        }
        image
    }

    /// White lines between the classes.
    fn boundaries<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        (left, top): (f64, f64),
    ) -> Result<(), DrawError> {
        for (_, first, _) in self.groups.iter().skip(1) {
            let at = SIDE * *first as f64 / self.order.len() as f64;
            canvas.line((left + at, top), (left + at, top + SIDE), 1.5, WHITE)?;
            canvas.line((left, top + at), (left + SIDE, top + at), 1.5, WHITE)?;
        }
        Ok(())
    }

    /// The class names on the left and below; those that would touch their neighbour are left out.
    fn names<DB: DrawingBackend>(
        &self,
        canvas: &Canvas<DB>,
        (left, top): (f64, f64),
    ) -> Result<(), DrawError> {
        let level = self.level_names();
        let mut free = f64::NEG_INFINITY;
        for (name, first, end) in &self.groups {
            let middle = SIDE * (first + end) as f64 / 2.0 / self.order.len() as f64;
            if middle < free {
                continue;
            }
            free = middle + LINE;
            canvas.text(name, (left - 8.0, top + middle), Type::new(SMALL, Anchor::Right))?;
            let (gap, kind) = match level {
                true => (16.0, NAMES),
                false => (8.0, Type::new(SMALL, Anchor::Right).up()),
            };
            canvas.text(name, (left + middle, top + SIDE + gap), kind)?;
        }
        Ok(())
    }
}

/// A class name that fits beside the matrix.
fn shortened(name: &str) -> String {
    match name.char_indices().nth(NAME) {
        Some((end, _)) if name.chars().count() > NAME + 1 => format!("{}…", &name[..end]),
        _ => name.to_string(),
    }
}

/// The scale of colours, zero at the bottom, with ticks and unit on its right.
fn color_bar<DB: DrawingBackend>(
    canvas: &Canvas<DB>,
    (left, top): (f64, f64),
    largest: f64,
    unit: &str,
) -> Result<(), DrawError> {
    let [width, height] = [BAR, SIDE].map(|side| side as u32 * RASTER);
    let mut image = RgbaImage::new(width, height, [255; 4]);
    for (i, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let [r, g, b] = perceptual(1.0 - (i / width as usize) as f64 / f64::from(height - 1));
        *pixel = [r, g, b, 255];
    }
    canvas.image(&image, (left, top))?;
    let scale: RangedCoordf64 = (0.0..if largest > 0.0 { largest } else { 1.0 }).into();
    let ticks = scale.key_points(7);
    let numbers = Numbers::for_ticks(&ticks);
    let mut widest = 0.0_f64;
    for tick in ticks {
        let y = top + SIDE * (1.0 - tick / scale.range().end);
        canvas.line((left + BAR, y), (left + BAR + 4.0, y), 1.0, PALE_INK)?;
        let (number, kind) = (numbers.write(tick), Type::new(SMALL, Anchor::Left));
        widest = widest.max(text_width(&number, kind));
        canvas.text(&number, (left + BAR + 7.0, y), kind)?;
    }
    let right = (left + BAR + 7.0 + widest + 18.0).min(left - LEFT - SIDE - GAP + COLUMN - 10.0);
    canvas.text(
        &format!("distance ({})", numbers.unit(unit)),
        (right, top + SIDE / 2.0),
        Type::new(TEXT, Anchor::Center).up(),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_are_shortened_on_a_letter() {
        assert_eq!(shortened("cat"), "cat");
        assert_eq!(shortened("elevenchars"), "elevenchars");
        assert_eq!(shortened("höchst unübersichtlich"), "höchst unü…");
    }
}
