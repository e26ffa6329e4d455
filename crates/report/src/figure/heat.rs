//! Static drawing of matrices: one with counts by itself, others two in a row with colour bars.

use super::axis::Axis;
use super::model::Heat;
use view::RgbaImage;
use view::canvas::{
    Anchor, Canvas, GRID, PAGE_WIDTH, PALE_INK, PIXELS_PER_UNIT, Point as Place, TextStyle, text_width,
};
use view::color::{Rgb, perceptual};

const COLUMN: f64 = PAGE_WIDTH / 2.0;
const WHITE: Rgb = [255; 3];
/// Height of a line of names.
const LINE: f64 = 16.0;
/// Around a grid of counts.
const MARGIN: f64 = 16.0;
/// The greatest side of a cell with a count, and the least in which a count fits.
const CELL: f64 = 46.0;
const LEGIBLE: f64 = 18.0;
/// Side of a matrix with a colour bar; above it the title, to its left the names.
const SIDE: f64 = 310.0;
const TITLE_HEIGHT: f64 = 40.0;
const LEFT: f64 = 92.0;
/// To the right of it: a gap, then the colour bar.
const GAP: f64 = 12.0;
const BAR: f64 = 14.0;
/// Characters of a name that fit into [`LEFT`], about.
const NAME: usize = 10;

pub(super) fn draw(heats: &[Heat]) -> Canvas {
    match heats {
        [heat] if heat.counts.is_some() => counts(heat),
        _ => pairs(heats),
    }
}

/// A matrix with counts and grid lines, in the middle of the figure.
fn counts(heat: &Heat) -> Canvas {
    let (n_rows, n_columns) = (heat.rows.len() as f64, heat.columns.len() as f64);
    let names = heat.columns.iter().map(|name| text_width(name, TextStyle::LABEL)).fold(0.0, f64::max) + 14.0;
    let room = PAGE_WIDTH - 2.0 * MARGIN - names - 30.0;
    let cell = CELL.min((room / n_columns).floor()).max(2.0);
    let (wide, high) = (cell * n_columns, cell * n_rows);
    let mut canvas = Canvas::new(PAGE_WIDTH as u32, (high + names + 3.0 * MARGIN + 30.0) as u32);
    let grid = Grid { heat, left: (PAGE_WIDTH - wide + names + 30.0) / 2.0, top: MARGIN, wide, high };
    canvas.image(grid.raster(), (grid.left, grid.top));
    for (row, own) in heat.counts.iter().flatten().enumerate().filter(|_| cell >= LEGIBLE) {
        for (column, count) in own.iter().enumerate().filter(|(_, count)| **count > 0) {
            let is_dark = grid.share(heat.values[row][column]) > 0.5;
            let [x, y] = [column, row].map(|at| (at as f64 + 0.5) * cell);
            let style = TextStyle::LABEL;
            let style = if is_dark { style.colored(WHITE).on_image() } else { style };
            canvas.text(count.to_string(), (grid.left + x, grid.top + y), style);
        }
    }
    for row in 0..=heat.rows.len() {
        let at = grid.top + row as f64 * cell;
        canvas.line((grid.left, at), (grid.left + wide, at), 1.0, GRID);
    }
    for column in 0..=heat.columns.len() {
        let at = grid.left + column as f64 * cell;
        canvas.line((at, grid.top), (at, grid.top + high), 1.0, GRID);
    }
    grid.names(&mut canvas, str::to_owned);
    canvas.text(&heat.y.name, (grid.left - names - 16.0, grid.top + high / 2.0), TextStyle::NAME.up());
    canvas.text(&heat.x.name, (grid.left + wide / 2.0, grid.top + high + names + MARGIN), TextStyle::NAME);
    canvas
}

/// Matrices with colour bars, two in a row.
fn pairs(heats: &[Heat]) -> Canvas {
    let foot = |heat: &Heat| {
        let grid = Grid { heat, left: 0.0, top: 0.0, wide: SIDE, high: SIDE };
        let longest = heat.x.ticks.iter().map(|(_, label)| text_width(&shortened(label), TextStyle::LABEL));
        if grid.has_level_names(shortened) { 34.0 } else { 24.0 + longest.fold(0.0, f64::max) }
    };
    let panel = TITLE_HEIGHT + SIDE + heats.iter().map(foot).fold(0.0, f64::max);
    let rows = heats.len().div_ceil(2) as f64;
    let mut canvas = Canvas::new(PAGE_WIDTH as u32, (rows * panel + 4.0) as u32);
    for (i, heat) in heats.iter().enumerate() {
        let (edge, top) = ((i % 2) as f64 * COLUMN, 4.0 + (i / 2) as f64 * panel);
        let grid = Grid { heat, left: edge + LEFT, top: top + TITLE_HEIGHT, wide: SIDE, high: SIDE };
        canvas.text(&heat.title, (grid.left + SIDE / 2.0, top + TITLE_HEIGHT / 2.0), TextStyle::TITLE);
        canvas.image(grid.raster(), (grid.left, grid.top));
        for &border in &heat.borders {
            let at = SIDE * border as f64 / heat.rows.len() as f64;
            canvas.line((grid.left + at, grid.top), (grid.left + at, grid.top + SIDE), 1.5, WHITE);
            canvas.line((grid.left, grid.top + at), (grid.left + SIDE, grid.top + at), 1.5, WHITE);
        }
        grid.names(&mut canvas, shortened);
        if let Some(bar) = &heat.bar {
            let corner = (grid.left + SIDE + GAP, grid.top);
            color_bar(&mut canvas, corner, bar, heat.tint, edge + COLUMN - 10.0);
        }
    }
    canvas
}

/// A matrix and its rectangle.
struct Grid<'a> {
    heat: &'a Heat,
    left: f64,
    top: f64,
    wide: f64,
    high: f64,
}

impl Grid<'_> {
    fn share(&self, value: f64) -> f64 {
        if self.heat.max > 0.0 { value / self.heat.max } else { 0.0 }
    }

    /// All cells as one image.
    fn raster(&self) -> RgbaImage {
        let size = [self.wide, self.high].map(|side| side as usize * PIXELS_PER_UNIT as usize);
        let Heat { rows, columns, values, tint, .. } = self.heat;
        RgbaImage::from_fn(size[0] as u32, size[1] as u32, |x, y| {
            let (row, column) = (y * rows.len() / size[1], x * columns.len() / size[0]);
            color(*tint, self.share(values[row][column]))
        })
    }

    /// The place of a tick along a side.
    fn middle(side: f64, tick: &(f64, String), n: usize) -> f64 {
        side * (tick.0 + 0.5) / n as f64
    }

    /// Whether the names fit side by side under the matrix.
    fn has_level_names(&self, written: impl Fn(&str) -> String) -> bool {
        let middle = |tick: &(f64, String)| Self::middle(self.wide, tick, self.heat.columns.len());
        let half = |tick: &(f64, String)| text_width(&written(&tick.1), TextStyle::LABEL) / 2.0 + 4.0;
        self.heat.x.ticks.windows(2).all(|t| middle(&t[1]) - middle(&t[0]) > half(&t[0]) + half(&t[1]))
    }

    /// The names at the left and below. Names that would touch the one before are left out.
    fn names(&self, canvas: &mut Canvas, written: impl Fn(&str) -> String) {
        let Heat { x, y, rows, columns, .. } = self.heat;
        let (gap, below) = match self.has_level_names(&written) {
            true => (16.0, TextStyle::LABEL),
            false => (8.0, TextStyle::LABEL.at(Anchor::Right).up()),
        };
        let mut free = [f64::NEG_INFINITY; 2];
        for i in 0..x.ticks.len().max(y.ticks.len()) {
            if let Some(tick) = y.ticks.get(i) {
                let middle = Self::middle(self.high, tick, rows.len());
                if middle >= free[0] {
                    free[0] = middle + LINE;
                    let place = (self.left - 8.0, self.top + middle);
                    canvas.text(written(&tick.1), place, TextStyle::LABEL.at(Anchor::Right));
                }
            }
            if let Some(tick) = x.ticks.get(i) {
                let middle = Self::middle(self.wide, tick, columns.len());
                if middle >= free[1] {
                    free[1] = middle + LINE;
                    canvas.text(written(&tick.1), (self.left + middle, self.top + self.high + gap), below);
                }
            }
        }
    }
}

/// The pixel for a share of the greatest value. A tint covers the page as far as the share says.
fn color(tint: Option<Rgb>, share: f64) -> [u8; 4] {
    let ([r, g, b], alpha) = tint.map_or_else(|| (perceptual(share), 1.0), |full| (full, share));
    [r, g, b, (255.0 * alpha).round() as u8]
}

/// A name that fits to the left of a matrix with a colour bar.
fn shortened(name: &str) -> String {
    match name.char_indices().nth(NAME) {
        Some((end, _)) if name.chars().count() > NAME + 1 => format!("{}…", &name[..end]),
        _ => name.to_string(),
    }
}

/// A colour bar with its lower end at the bottom, and its ticks and name to its right, up to `limit`.
fn color_bar(canvas: &mut Canvas, (left, top): Place, axis: &Axis, tint: Option<Rgb>, limit: f64) {
    let [width, height] = [BAR, SIDE].map(|side| side as u32 * PIXELS_PER_UNIT);
    let pixel = |_, row| color(tint, 1.0 - row as f64 / f64::from(height - 1));
    canvas.image(RgbaImage::from_fn(width, height, pixel), (left, top));
    let style = TextStyle::LABEL.at(Anchor::Left);
    let mut widest = 0.0_f64;
    for (share, label) in axis.placed_ticks() {
        let y = top + SIDE * (1.0 - share);
        canvas.line((left + BAR, y), (left + BAR + 4.0, y), 1.0, PALE_INK);
        widest = widest.max(text_width(label, style));
        canvas.text(label, (left + BAR + 7.0, y), style);
    }
    let right = (left + BAR + 7.0 + widest + 18.0).min(limit);
    canvas.text(&axis.name, (right, top + SIDE / 2.0), TextStyle::NAME.up());
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
