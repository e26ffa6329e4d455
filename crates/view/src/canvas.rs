//! A drawing as a list of elements, which becomes a PNG and an SVG of the same content.
//!
//! Drawings are measured in **units**: [`PAGE_WIDTH`] of them are as wide as the text of a printed page (7 inches), so
//! a type size of 16 units prints at 8 points. Both files have a whole number of pixels per unit.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, FontTransform, TextStyle as PlottersStyle, register_font};

use files::write_bytes;

use crate::color::Rgb;
use crate::error::ViewError;
use crate::image::{RgbaImage, encode_png};

/// Pixels per unit in both files and in every raster inside them: 286 dots per inch in print.
pub const PIXELS_PER_UNIT: u32 = 2;

/// The PNG is drawn this many times finer and averaged, which smooths every edge.
const OVERSAMPLING: u32 = 2;

/// How far text moves down for its letters to be centred vertically, in ems: backends disagree on what the middle
/// of a text is.
const BITMAP_TEXT_DROP: f64 = 0.22;
const SVG_TEXT_DROP: f64 = 0.06;

/// The name of the embedded DejaVu Sans. The SVG asks its viewer for it, so it lists fonts of similar width.
const FONT: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, sans-serif";

/// Width of a figure that fills the text of a page, in units.
pub const PAGE_WIDTH: f64 = 1000.0;

/// Colour of text and lines.
pub const INK: Rgb = [34; 3];
/// Colour of secondary text and frames.
pub const PALE_INK: Rgb = [105; 3];
/// Colour of grid lines.
pub const GRID: Rgb = [228; 3];

/// A point in units, from the top left corner to the right and down.
pub type Point = (f64, f64);

/// The point of a text that is placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// The left end (of text that runs up, the lower one).
    Left,
    /// The middle.
    Center,
    /// The right end (of text that runs up, the upper one).
    Right,
}

/// How a text looks. Its anchor is always at half its height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextStyle {
    size: u32,
    bold: bool,
    color: Rgb,
    anchor: Anchor,
    upwards: bool,
}

impl TextStyle {
    /// Plain text and names of axes.
    pub const NAME: Self = Self::new(16, Anchor::Center);
    /// Notes and tick labels.
    pub const LABEL: Self = Self::new(14, Anchor::Center);
    /// Titles of panels.
    pub const TITLE: Self = Self::new(19, Anchor::Center).bold();

    /// Text of a type size in units, from left to right in ink.
    #[must_use]
    pub const fn new(size: u32, anchor: Anchor) -> Self {
        Self { size, bold: false, color: INK, anchor, upwards: false }
    }

    /// The same style with another anchor.
    #[must_use]
    pub const fn at(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    /// The same style in bold.
    #[must_use]
    pub const fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// The same style in another colour.
    #[must_use]
    pub const fn colored(self, color: Rgb) -> Self {
        Self { color, ..self }
    }

    /// The same style from bottom to top.
    #[must_use]
    pub const fn up(self) -> Self {
        Self { upwards: true, ..self }
    }

    /// The style for plotters, of a backend with `pixels` per unit.
    fn plotters(self, pixels: u32) -> PlottersStyle<'static> {
        // plotters measures a font by its line, which is 1.164 em in DejaVu.
        let size = f64::from(self.size * pixels) * 1.164;
        let weight = if self.bold { FontStyle::Bold } else { FontStyle::Normal };
        let font = FontDesc::new(FontFamily::Name(FONT), size, weight);
        let font = if self.upwards { font.transform(FontTransform::Rotate270) } else { font };
        let h = match self.anchor {
            Anchor::Left => HPos::Left,
            Anchor::Center => HPos::Center,
            Anchor::Right => HPos::Right,
        };
        PlottersStyle { font, color: rgb(self.color).to_backend_color(), pos: Pos::new(h, VPos::Center) }
    }
}

/// Length of a text, in units.
#[must_use]
pub fn text_width(text: &str, style: TextStyle) -> f64 {
    // Measured large, as the backend rounds to whole pixels.
    const FINE: u32 = 8;
    let measured = register_fonts().ok().and_then(|()| style.plotters(FINE).font.layout_box(text).ok());
    match measured {
        Some((_, (width, _))) => f64::from(width) / f64::from(FINE),
        // Without a font saving fails; until then, a common proportion.
        None => 0.6 * f64::from(style.size) * text.chars().count() as f64,
    }
}

/// A drawing: elements in the order in which they cover each other.
#[derive(Debug, Clone)]
pub struct Canvas {
    size: (u32, u32),
    elements: Vec<Element>,
}

#[derive(Debug, Clone)]
enum Element {
    Text { text: String, at: Point, style: TextStyle },
    Image { image: RgbaImage, corner: Point },
    Path { points: Vec<Point>, width: f64, color: Rgb },
    Polygon { origin: Point, points: Vec<Point>, color: Rgb, opacity: f64 },
}

impl Canvas {
    /// An empty drawing of this size, in units.
    #[must_use]
    pub fn new(width: u32, height: u32) -> Self {
        Self { size: (width, height), elements: Vec::new() }
    }

    /// Writes a text with its anchor at `at`.
    pub fn text(&mut self, text: impl Into<String>, at: Point, style: TextStyle) {
        self.elements.push(Element::Text { text: text.into(), at, style });
    }

    /// Draws a raster of [`PIXELS_PER_UNIT`] with its top left corner at `corner`.
    pub fn image(&mut self, image: RgbaImage, corner: Point) {
        self.elements.push(Element::Image { image, corner });
    }

    /// Draws a straight line of `width` units.
    pub fn line(&mut self, from: Point, to: Point, width: f64, color: Rgb) {
        self.path(vec![from, to], width, color);
    }

    /// Draws straight lines of `width` units from point to point.
    pub fn path(&mut self, points: Vec<Point>, width: f64, color: Rgb) {
        self.elements.push(Element::Path { points, width, color });
    }

    /// Fills a polygon whose corners are given relative to `origin`. The opacity is a share, 1 for opaque.
    pub fn polygon(&mut self, origin: Point, points: Vec<Point>, color: Rgb, opacity: f64) {
        self.elements.push(Element::Polygon { origin, points, color, opacity });
    }

    /// Writes a PNG and an SVG and returns their paths: the stem, the part and the extension.
    ///
    /// # Errors
    /// [`ViewError::Draw`] when a backend fails, [`ViewError::File`] when a file cannot be written.
    pub fn save(&self, stem: &Path, part: &str) -> Result<Vec<PathBuf>, ViewError> {
        let failed = |e: DrawError| ViewError::draw(stem.display(), e.0);
        let path = |extension: &str| {
            let mut name = stem.as_os_str().to_owned();
            name.push(part);
            name.push(extension);
            PathBuf::from(name)
        };
        let (png, svg) = (path(".png"), path(".svg"));
        write_bytes(&png, &self.png().map_err(failed)?)?;
        write_bytes(&svg, self.svg().map_err(failed)?.as_bytes())?;
        Ok(vec![png, svg])
    }

    /// The share of every pixel that a black drawing covers, 0 to 255, row by row, with one pixel per unit.
    ///
    /// # Errors
    /// [`ViewError::Draw`] when the backend fails.
    pub fn coverage(&self) -> Result<Vec<u8>, ViewError> {
        let pixels = self.bitmap(1).map_err(|e| ViewError::draw("a drawing", e.0))?;
        Ok(pixels.chunks_exact(3).map(|p| 255 - p[1]).collect())
    }

    fn png(&self) -> Result<Vec<u8>, DrawError> {
        let (width, height) = (self.size.0 * PIXELS_PER_UNIT, self.size.1 * PIXELS_PER_UNIT);
        let pixels = self.bitmap(PIXELS_PER_UNIT)?;
        encode_png(width, height, png::ColorType::Rgb, &pixels).map_err(|e| DrawError(e.to_string()))
    }

    /// RGB pixels, row by row, with `pixels` per unit.
    fn bitmap(&self, pixels: u32) -> Result<Vec<u8>, DrawError> {
        let fine = pixels * OVERSAMPLING;
        let (width, height) = (self.size.0 * fine, self.size.1 * fine);
        let mut bytes = vec![255; width as usize * height as usize * 3];
        self.draw(BitMapBackend::with_buffer(&mut bytes, (width, height)), fine, BITMAP_TEXT_DROP)?;
        Ok(average(&bytes, width as usize, OVERSAMPLING as usize))
    }

    fn svg(&self) -> Result<String, DrawError> {
        let (width, height) = self.size;
        let (wide, high) = (width * PIXELS_PER_UNIT, height * PIXELS_PER_UNIT);
        let mut svg = String::new();
        self.draw(SVGBackend::with_string(&mut svg, (wide, high)), PIXELS_PER_UNIT, SVG_TEXT_DROP)?;
        // The backend writes the size in pixels instead of units, and an invalid media type.
        let svg = svg.replacen(
            &format!("width=\"{wide}\" height=\"{high}\""),
            &format!("width=\"{width}\" height=\"{height}\""),
            1,
        );
        Ok(svg.replace("\"data:png;base64,", "\"data:image/png;base64,"))
    }

    fn draw<DB: DrawingBackend>(&self, backend: DB, pixels: u32, text_drop: f64) -> Result<(), DrawError> {
        register_fonts()?;
        let area = backend.into_drawing_area();
        area.fill(&WHITE)?;
        for element in &self.elements {
            element.draw(&area, pixels, text_drop)?;
        }
        Ok(area.present()?)
    }
}

impl Element {
    fn draw<DB: DrawingBackend>(
        &self,
        area: &DrawingArea<DB, Shift>,
        pixels: u32,
        text_drop: f64,
    ) -> Result<(), DrawError> {
        let px = |units: f64| (units * f64::from(pixels)).round() as i32;
        let at = |(x, y): Point| (px(x), px(y));
        match self {
            Self::Text { text, at: (x, y), style } => {
                let down = text_drop * f64::from(style.size);
                let (x, y) = if style.upwards { (x + down, *y) } else { (*x, y + down) };
                area.draw_text(text, &style.plotters(pixels), at((x, y)))?;
            }
            Self::Image { image, corner } => {
                let zoom = pixels / PIXELS_PER_UNIT;
                let size = (image.width() * zoom, image.height() * zoom);
                let element = BitMapElement::with_owned_buffer(at(*corner), size, image.rgb_bytes(zoom));
                area.draw(&element.ok_or_else(|| DrawError("a raster has too few pixels".into()))?)?;
            }
            Self::Path { points, width, color } => {
                let points: Vec<(i32, i32)> = points.iter().copied().map(at).collect();
                let stroke = rgb(*color).stroke_width(px(*width).max(1) as u32);
                area.draw(&PathElement::new(points, stroke))?;
            }
            Self::Polygon { origin, points, color, opacity } => {
                // Rounded relative to the origin, so that equal markers have equal pixels.
                let (left, top) = at(*origin);
                let points: Vec<(i32, i32)> =
                    points.iter().copied().map(at).map(|(x, y)| (left + x, top + y)).collect();
                area.draw(&Polygon::new(points, rgb(*color).mix(*opacity)))?;
            }
        }
        Ok(())
    }
}

fn rgb([r, g, b]: Rgb) -> RGBColor {
    RGBColor(r, g, b)
}

/// Why a backend failed, as text: the error types of the two backends have nothing else in common.
#[derive(Debug)]
struct DrawError(String);

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for DrawError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// Registers the embedded font: without a system library plotters has none of its own.
fn register_fonts() -> Result<(), DrawError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let done = REGISTERED.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok()
            && register_font(FONT, FontStyle::Bold, dejavu::sans::bold()).is_ok()
    });
    if *done { Ok(()) } else { Err(DrawError("the embedded font cannot be read".into())) }
}

/// Averages squares of `n` x `n` RGB pixels.
fn average(pixels: &[u8], width: usize, n: usize) -> Vec<u8> {
    let small = width / n;
    let mut rows = Vec::with_capacity(pixels.len() / (n * n));
    for band in pixels.chunks_exact((width * 3 * n).max(1)) {
        let mut sums = vec![0_u32; small * 3];
        for line in band.chunks_exact(width * 3) {
            for (i, &byte) in line.iter().enumerate() {
                sums[i / 3 / n * 3 + i % 3] += u32::from(byte);
            }
        }
        let count = (n * n) as u32;
        rows.extend(sums.iter().map(|sum| ((sum + count / 2) / count) as u8));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_width_grows_with_the_text_and_its_weight() {
        let style = TextStyle::NAME.at(Anchor::Left);
        assert_eq!(text_width("", style), 0.0);
        let digit = text_width("0", style);
        assert!(
            (digit / f64::from(style.size) - 0.636).abs() < 0.02,
            "a digit of DejaVu Sans is 0.636 em wide: {digit}"
        );
        assert!((text_width("0000", style) - 4.0 * digit).abs() < 0.5);
        assert!(text_width("wide", style.bold()) > text_width("wide", style));
    }

    /// A drawing with one word on it.
    fn word(width: u32, height: u32) -> Canvas {
        let mut canvas = Canvas::new(width, height);
        canvas.text("word", (5.0, 15.0), TextStyle::NAME.at(Anchor::Left));
        canvas
    }

    #[test]
    fn both_files_have_the_size_of_the_canvas() {
        let folder = tempfile::tempdir().unwrap();
        let files = word(60, 30).save(&folder.path().join("a"), ".b").unwrap();
        assert_eq!(files, [folder.path().join("a.b.png"), folder.path().join("a.b.svg")]);
        let png = png::Decoder::new(std::fs::File::open(&files[0]).unwrap()).read_info().unwrap();
        assert_eq!((png.info().width, png.info().height), (120, 60));
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert!(svg.starts_with("<svg width=\"60\" height=\"30\" viewBox=\"0 0 120 60\""), "{svg}");
    }

    #[test]
    fn a_failing_backend_is_an_error_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = word(0, 30).save(&folder.path().join("empty"), "").unwrap_err();
        assert!(matches!(error, ViewError::Draw { .. }), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn averaging_halves_an_image() {
        let row = [0, 10, 20, 100, 110, 121];
        assert_eq!(average(&[row, row].concat(), 2, 2), [50, 60, 71]);
    }
}
