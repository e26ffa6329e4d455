//! A colour bar with ticks next to an image. One unit of the canvas is one pixel here.

use mesh::TriMesh;

use super::draw::render;
use super::options::{Background, RenderOptions};
use super::surface::{ISOLINE_LIGHT, Surface};
use crate::canvas::{Anchor, Canvas, TextStyle, text_width};
use crate::color::{ColorMap, Rgb, from_linear, mix, to_linear, value_range};
use crate::error::ViewError;
use crate::image::RgbaImage;
use crate::numbers::{Numbers, ticks};

/// Draws like [`render`], with a colour bar, its ticks and its `name` to the right of the mesh, in an image of the
/// same size.
///
/// There is no bar if the surface has no finite numbers, or if the bar would take more than half of the image.
///
/// # Errors
/// [`ViewError::Draw`] if text cannot be written.
pub fn render_with_bar(mesh: &TriMesh, options: &RenderOptions, name: &str) -> Result<RgbaImage, ViewError> {
    let Some(bar) = Bar::new(options, name) else { return Ok(render(mesh, options)) };
    let room = RenderOptions { width: bar.size.0 - bar.width(), ..options.clone() };
    let mut image = bar.with_room(&render(mesh, &room), options.background);
    bar.paint(&mut image);
    let pen = pen(options.background);
    for (pixel, cover) in image.pixels_mut().iter_mut().zip(bar.labels().coverage()?) {
        *pixel = over(*pixel, pen, f64::from(cover) / 255.0);
    }
    Ok(image)
}

/// The bar and its labels, in pixels.
struct Bar {
    /// Size of the whole image.
    size: (u32, u32),
    /// Type size.
    em: f64,
    /// Values at the lower and the upper end.
    range: [f64; 2],
    /// Steps between isolines, 0 for none.
    steps: u32,
    /// Values with their labels.
    ticks: Vec<(f64, String)>,
    name: String,
    colors: ColorMap,
}

impl Bar {
    fn new(options: &RenderOptions, name: &str) -> Option<Self> {
        let Surface::Scalars { values, range, isolines } = &options.surface else { return None };
        let [low, high] = range.or_else(|| value_range(values))?;
        // The range of the surface's colours if there is only one value.
        let high = if high > low { high } else { low + 1.0 };
        if !(high - low).is_finite() {
            return None;
        }
        let size = (options.width.clamp(1, 8192), options.height.clamp(1, 8192));
        let em = (f64::from(size.0.min(size.1)) / 36.0).clamp(11.0, 64.0).round();
        let (name, ticks) = (name.to_owned(), Vec::new());
        let mut bar =
            Self { size, em, range: [low, high], steps: *isolines, ticks, name, colors: options.colors };
        let ticks = bar.tick_values();
        let numbers = Numbers::for_ticks(&ticks);
        bar.name = match numbers.unit("").as_str() {
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
        let values = ticks(self.range, most);
        if values.len() < 2 { vec![low, high] } else { values }
    }

    fn style(&self, anchor: Anchor) -> TextStyle {
        TextStyle::new(self.em as u32, anchor).colored([0; 3])
    }

    fn height(&self) -> f64 {
        (f64::from(self.size.1) * 0.72).round()
    }

    fn top(&self) -> f64 {
        ((f64::from(self.size.1) - self.height()) / 2.0).round()
    }

    /// From the left side of the bar to the right side of the image: the bar, ticks, numbers and name.
    fn extent(&self) -> f64 {
        let width = |(_, text): &(f64, String)| text_width(text, self.style(Anchor::Left));
        let numbers = self.ticks.iter().map(width).fold(0.0, f64::max).ceil();
        self.em * (1.0 + 0.8) + numbers + self.em * 2.1
    }

    fn left(&self) -> f64 {
        f64::from(self.size.0) - self.extent()
    }

    /// Pixels taken from the mesh.
    fn width(&self) -> u32 {
        (self.extent() + 0.3 * self.em) as u32
    }

    /// The row of a value.
    fn row(&self, value: f64) -> f64 {
        let [low, high] = self.range;
        self.top() + self.height() * (1.0 - (value - low) / (high - low))
    }

    /// The image of the mesh, extended to the right by empty space for the bar.
    fn with_room(&self, mesh: &RgbaImage, background: Background) -> RgbaImage {
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

    /// Ticks, numbers and name, in black.
    fn labels(&self) -> Canvas {
        let mut canvas = Canvas::new(self.size.0, self.size.1);
        let right = self.left() + self.em;
        for (value, text) in &self.ticks {
            let row = self.row(*value);
            canvas.line((right, row), (right + 0.4 * self.em, row), (self.em / 14.0).max(1.0), [0; 3]);
            canvas.text(text, (right + 0.8 * self.em, row), self.style(Anchor::Left));
        }
        let middle = self.top() + self.height() / 2.0;
        let place = (f64::from(self.size.0) - 1.1 * self.em, middle);
        canvas.text(&self.name, place, self.style(Anchor::Center).up());
        canvas
    }

    /// Fills the bar with the colour map and its isolines.
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
            let [r, g, b] = self.colors.color(share).map(|c| from_linear(to_linear(c) * light));
            row[left..right].fill([r, g, b, 255]);
        }
    }
}

/// A text colour that contrasts with the background.
fn pen(background: Background) -> Rgb {
    let light = match background {
        // As far from white as from black.
        Background::Transparent => return [118; 3],
        Background::White => 1.0,
        Background::Color(color) => {
            let [r, g, b] = color.map(to_linear);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        }
    };
    if light > 0.18 { [34; 3] } else { [235; 3] }
}

/// A pixel of which an opaque colour covers `share`.
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
    fn the_bar_shares_the_image_with_the_mesh() {
        let options = options(heights());
        let (plain, with_bar) =
            (render(&sphere(12), &options), render_with_bar(&sphere(12), &options, "z").unwrap());
        assert_eq!((with_bar.width(), with_bar.height()), (320, 240));
        assert!(plain != with_bar);
        let other = RenderOptions { colors: ColorMap::Magma, ..options.clone() };
        assert!(render_with_bar(&sphere(12), &other, "z").unwrap() != with_bar);
        let bar = Bar::new(&options, "z").unwrap();
        let column = (bar.left() + bar.em / 2.0) as u32;
        let [low, high] = [bar.row(bar.range[0]) as u32 - 1, bar.row(bar.range[1]) as u32];
        for (row, end) in [(low, ColorMap::Viridis.color(0.0)), (high, ColorMap::Viridis.color(1.0))] {
            let found = with_bar.pixel(column, row);
            assert!(found.iter().zip(end).all(|(a, b)| a.abs_diff(b) < 8), "{found:?} {end:?}");
        }
        let lines = (high..=low).filter(|&y| with_bar.pixel(column, y).iter().all(|c| *c > 150)).count();
        assert_eq!(lines, 0, "the bar has no holes");
        assert_eq!(with_bar, render_with_bar(&sphere(12), &options, "z").unwrap());
    }

    #[test]
    fn ticks_are_round_and_inside_the_range() {
        let bar = |values| Bar::new(&options(values), "field").unwrap();
        let written = |bar: Bar| bar.ticks.into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(written(bar(vec![0.0, 20.0])), ["0", "5", "10", "15", "20"]);
        assert_eq!(bar(vec![0.0, 20_000.0]).name, "field (×10³)");
        // A single value, and two neighbouring floating-point numbers.
        assert_eq!(bar(vec![3.0, 3.0]).range, [3.0, 4.0]);
        assert_eq!(bar(vec![1e17, 1e17 + 16.0]).ticks.len(), 2);
    }

    #[test]
    fn surfaces_without_finite_numbers_and_small_images_have_no_bar() {
        let has_bar = |options: &RenderOptions| Bar::new(options, "").is_some();
        assert!(has_bar(&options(heights())));
        assert!(!has_bar(&options(vec![f64::NAN])) && !has_bar(&options(vec![])));
        assert!(!has_bar(&options(vec![-1e308, 1e308])));
        assert!(!has_bar(&RenderOptions { width: 90, ..options(heights()) }));
        assert!(!has_bar(&RenderOptions { height: 60, ..options(heights()) }));
        assert!(!has_bar(&RenderOptions::default()));
    }

    #[test]
    fn labels_contrast_with_every_background() {
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
    fn a_partly_covered_pixel_mixes_both_colours() {
        assert_eq!(over([10, 20, 30, 40], [0; 3], 0.0), [10, 20, 30, 40]);
        assert_eq!(over([10, 20, 30, 40], [1, 2, 3], 1.0), [1, 2, 3, 255]);
        assert_eq!(over([200, 200, 200, 255], [0; 3], 0.5), [100, 100, 100, 255]);
        assert_eq!(over([0; 4], [80; 3], 0.5), [80, 80, 80, 128]);
    }
}
