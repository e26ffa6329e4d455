//! The scale beside a picture of numbers: the colour map with ticks, written in pixels.

use mesh::TriMesh;
use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{BLACK, DrawingBackend};

use super::{Background, ISOLINE_LIGHT, RenderOptions, Surface, render, value_range};
use crate::canvas::{Anchor, Canvas, DrawError, Drawing, Type, ink, text_width};
use crate::color::{Rgb, from_linear, mix, perceptual, to_linear};
use crate::numbers::Numbers;
use crate::{RgbaImage, ViewError};

/// Draws like [`render`] and sets a colour bar with numbers and its `name` to the right of the mesh, in a
/// picture of the same size.
///
/// There is no bar where there is nothing to tell: a surface without numbers, or without a finite one, or
/// a picture that the bar would take more than half of.
///
/// # Errors
/// [`ViewError::Draw`] when text cannot be written.
pub fn render_with_bar(mesh: &TriMesh, options: &RenderOptions, name: &str) -> Result<RgbaImage, ViewError> {
    let Some(bar) = Bar::new(options, name) else { return Ok(render(mesh, options)) };
    let room = RenderOptions { width: bar.size.0 - bar.width(), ..options.clone() };
    let mut image = bar.beside(&render(mesh, &room), options.background);
    bar.paint(&mut image);
    let failed = |e: DrawError| ViewError::Draw { figure: "colour bar".into(), reason: e.reason() };
    let pen = pen(options.background);
    let covers = ink(&bar).map_err(failed)?;
    for (pixel, cover) in image.pixels_mut().iter_mut().zip(covers) {
        *pixel = over(*pixel, pen, f64::from(cover) / 255.0);
    }
    Ok(image)
}

/// Where everything is, in pixels.
struct Bar {
    /// Of the whole picture.
    size: (u32, u32),
    /// Of the type.
    em: f64,
    /// The values at the lower and the upper end.
    range: [f64; 2],
    /// Steps between isolines, 0 for none.
    steps: u32,
    /// Values with their texts.
    ticks: Vec<(f64, String)>,
    name: String,
}

impl Bar {
    fn new(options: &RenderOptions, name: &str) -> Option<Self> {
        let Surface::Scalars { values, range, isolines } = &options.surface else { return None };
        let [low, high] = range.or_else(|| value_range(values))?;
        // What the surface is painted with where there is one value only.
        let high = if high > low { high } else { low + 1.0 };
        if !(high - low).is_finite() {
            return None;
        }
        let size = (options.width.clamp(1, 8192), options.height.clamp(1, 8192));
        let em = (f64::from(size.0.min(size.1)) / 36.0).clamp(11.0, 64.0).round();
        let mut bar =
            Self { size, em, range: [low, high], steps: *isolines, ticks: Vec::new(), name: name.to_owned() };
        let ticks = bar.tick_values();
        let numbers = Numbers::for_ticks(&ticks);
        bar.name = match numbers.unit("").trim_end_matches(", ") {
            "" => bar.name,
            power => format!("{} ({power})", bar.name),
        };
        bar.ticks = ticks.into_iter().map(|t| (t, numbers.write(t))).collect();
        (bar.width() <= size.0 / 2 && bar.em * 8.0 <= f64::from(size.1)).then_some(bar)
    }

    fn tick_values(&self) -> Vec<f64> {
        let [low, high] = self.range;
        // A step below the spacing of floating-point numbers would never arrive.
        if high - low <= 1e-9 * low.abs().max(high.abs()) {
            return vec![low, high];
        }
        let most = (self.height() / (2.5 * self.em)).clamp(2.0, 8.0) as usize;
        let values = RangedCoordf64::from(low..high).key_points(most);
        if values.len() < 2 { vec![low, high] } else { values }
    }

    fn text(&self) -> Type {
        Type { color: BLACK, ..Type::new(self.em as u32, Anchor::Left) }
    }

    fn height(&self) -> f64 {
        (f64::from(self.size.1) * 0.72).round()
    }

    fn top(&self) -> f64 {
        ((f64::from(self.size.1) - self.height()) / 2.0).round()
    }

    /// Width of all numbers.
    fn numbers(&self) -> f64 {
        self.ticks.iter().map(|(_, text)| text_width(text, self.text())).fold(0.0, f64::max).ceil()
    }

    /// From the bar's left side to the right side of the picture: the bar, ticks, numbers, the name.
    fn extent(&self) -> f64 {
        self.em * (1.0 + 0.8) + self.numbers() + self.em * 2.1
    }

    fn left(&self) -> f64 {
        f64::from(self.size.0) - self.extent()
    }

    /// Pixels taken from the mesh.
    fn width(&self) -> u32 {
        (self.extent() + 0.3 * self.em) as u32
    }

    /// Row at which a value is.
    fn row(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        self.top() + self.height() * (1.0 - (value - low) / (high - low))
    }

    /// The picture of the mesh on the left of an empty one.
    fn beside(&self, mesh: &RgbaImage, background: Background) -> RgbaImage {
        let empty = match background {
            Background::White => [255; 4],
            Background::Color([r, g, b]) => [r, g, b, 255],
            Background::Transparent => [0; 4],
        };
        let mut image = RgbaImage::new(self.size.0, self.size.1, empty);
        let lines = image.pixels_mut().chunks_exact_mut(self.size.0 as usize);
        for (line, part) in lines.zip(mesh.pixels().chunks_exact(mesh.width() as usize)) {
            line[..part.len()].copy_from_slice(part);
        }
        image
    }

    fn paint(&self, image: &mut RgbaImage) {
        let (left, right) = (self.left() as usize, (self.left() + self.em) as usize);
        let (top, height) = (self.top() as usize, self.height() as usize);
        let half_line = self.em / 24.0;
        let rows = image.pixels_mut().chunks_exact_mut(self.size.0 as usize).skip(top).take(height);
        for (i, row) in rows.enumerate() {
            let share = 1.0 - (i as f64 + 0.5) / height as f64;
            let level = share * f64::from(self.steps);
            let line = level.round();
            let pixels_away = (level - line).abs() * height as f64 / f64::from(self.steps.max(1));
            let is_inside = line > 0.5 && line < f64::from(self.steps) - 0.5;
            let light = if is_inside && pixels_away <= half_line.max(0.5) { ISOLINE_LIGHT } else { 1.0 };
            let [r, g, b] = perceptual(share).map(|c| from_linear(to_linear(c) * light));
            row[left..right].fill([r, g, b, 255]);
        }
    }
}

impl Drawing for Bar {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
        let right = self.left() + self.em;
        for (value, text) in &self.ticks {
            let row = self.row(*value);
            canvas.line((right, row), (right + 0.4 * self.em, row), (self.em / 14.0).max(1.0), BLACK)?;
            canvas.text(text, (right + 0.8 * self.em, row), self.text())?;
        }
        let middle = self.top() + self.height() / 2.0;
        let name = Type { anchor: Anchor::Center, ..self.text().up() };
        canvas.text(&self.name, (f64::from(self.size.0) - 1.1 * self.em, middle), name)
    }
}

/// The colour that is read best on a background: dark, unless that is dark itself.
fn pen(background: Background) -> Rgb {
    let light = match background {
        // Whatever is behind: as far from white as from black.
        Background::Transparent => return [118; 3],
        Background::White => 1.0,
        Background::Color(color) => {
            let [r, g, b] = color.map(to_linear);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        }
    };
    if light > 0.18 { [34; 3] } else { [235; 3] }
}

/// A pixel with `share` of it covered by an opaque colour.
fn over([r, g, b, alpha]: [u8; 4], color: Rgb, share: f64) -> [u8; 4] {
    if share <= 0.0 {
        return [r, g, b, alpha];
    }
    let below = f64::from(alpha) / 255.0 * (1.0 - share);
    let whole = below + share;
    let [r, g, b] = mix([r, g, b], color, share / whole);
    [r, g, b, (whole * 255.0).round() as u8]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::sphere;

    fn options(values: Vec<f64>) -> RenderOptions {
        let surface = Surface::Scalars { values, range: None, isolines: 4 };
        RenderOptions { width: 320, height: 240, surface, ..RenderOptions::default() }
    }

    fn heights() -> Vec<f64> {
        sphere(12).positions.iter().map(|p| p.z).collect()
    }

    #[test]
    fn a_bar_stands_beside_the_mesh_in_a_picture_of_the_same_size() {
        let options = options(heights());
        let (plain, with_bar) =
            (render(&sphere(12), &options), render_with_bar(&sphere(12), &options, "z").unwrap());
        assert_eq!((with_bar.width(), with_bar.height()), (320, 240));
        assert!(plain != with_bar);
        let bar = Bar::new(&options, "z").unwrap();
        let column = (bar.left() + bar.em / 2.0) as u32;
        let [low, high] = [bar.row(bar.range[0]) as u32 - 1, bar.row(bar.range[1]) as u32];
        for (row, end) in [(low, perceptual(0.0)), (high, perceptual(1.0))] {
            let found = with_bar.pixel(column, row);
            assert!(found.iter().zip(end).all(|(a, b)| a.abs_diff(b) < 8), "{found:?} {end:?}");
        }
        let lines = (high..=low).filter(|&y| with_bar.pixel(column, y).iter().all(|c| *c > 150)).count();
        assert_eq!(lines, 0, "the bar has no holes");
        assert_eq!(with_bar, render_with_bar(&sphere(12), &options, "z").unwrap());
    }

    #[test]
    fn ticks_are_round_numbers_inside_the_range() {
        let bar = |values| Bar::new(&options(values), "field").unwrap();
        let written = |bar: Bar| bar.ticks.into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(written(bar(vec![0.0, 20.0])), ["0", "5", "10", "15", "20"]);
        assert_eq!(bar(vec![0.0, 20_000.0]).name, "field (×10³)");
        // One value, and values that floating-point numbers hardly tell apart.
        assert_eq!(bar(vec![3.0, 3.0]).range, [3.0, 4.0]);
        assert_eq!(bar(vec![1e17, 1e17 + 16.0]).ticks.len(), 2);
    }

    #[test]
    fn what_has_nothing_to_tell_has_no_bar() {
        let has_bar = |options: &RenderOptions| Bar::new(options, "").is_some();
        assert!(has_bar(&options(heights())));
        assert!(!has_bar(&options(vec![f64::NAN])) && !has_bar(&options(vec![])));
        assert!(!has_bar(&options(vec![-1e308, 1e308])));
        assert!(!has_bar(&RenderOptions { width: 90, ..options(heights()) }));
        assert!(!has_bar(&RenderOptions { height: 60, ..options(heights()) }));
        assert!(!has_bar(&RenderOptions::default()));
    }

    #[test]
    fn ink_is_seen_on_every_background() {
        let on = |background| {
            let options = RenderOptions { background, ..options(heights()) };
            let image = render_with_bar(&sphere(12), &options, "z").unwrap();
            let right = |p: &(usize, &[u8; 4])| p.0 % 320 > 270;
            image
                .pixels()
                .iter()
                .copied()
                .enumerate()
                .filter(|(i, p)| right(&(*i, p)))
                .map(|(_, p)| p)
                .collect::<Vec<_>>()
        };
        assert!(on(Background::White).iter().any(|p| p[0] < 60));
        assert!(on(Background::Color([20, 20, 24])).iter().any(|p| p[0] > 200));
        let clear = on(Background::Transparent);
        assert!(
            clear.iter().any(|p| p[3] == 0) && clear.iter().any(|p| p[0].abs_diff(118) < 3 && p[3] > 200)
        );
    }

    #[test]
    fn covering_keeps_what_is_below_visible() {
        assert_eq!(over([10, 20, 30, 40], [0; 3], 0.0), [10, 20, 30, 40]);
        assert_eq!(over([10, 20, 30, 40], [1, 2, 3], 1.0), [1, 2, 3, 255]);
        assert_eq!(over([200, 200, 200, 255], [0; 3], 0.5), [100, 100, 100, 255]);
        assert_eq!(over([0; 4], [80; 3], 0.5), [80, 80, 80, 128]);
    }
}
