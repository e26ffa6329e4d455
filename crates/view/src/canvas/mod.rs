//! A drawing as a list of elements, which becomes a PNG, an SVG and a PDF of the same content.
//!
//! Drawings are measured in **units**: [`PAGE_WIDTH`] of them are as wide as the text of a printed page (7 inches), so
//! a type size of 16 units prints at 8 points. Rasters have a whole number of pixels per unit.

mod bitmap;
mod pdf;
mod svg;

use std::path::{Path, PathBuf};

use files::write_bytes;

use crate::color::Rgb;
use crate::error::ViewError;
use crate::image::RgbaImage;
pub use bitmap::text_width;
pub use svg::dark;

/// Pixels per unit of the PNG and of every raster: 286 dots per inch in print.
pub const PIXELS_PER_UNIT: u32 = 2;

/// Width of a figure that fills the text of a page, in units.
pub const PAGE_WIDTH: f64 = 1000.0;

/// From the middle of a text down to its baseline, in ems.
const DROP: f64 = 0.33;

/// Colour of the background.
pub const PAPER: Rgb = [255; 3];
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
    /// Whether dark pages keep the colour.
    is_fixed: bool,
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
        Self { size, bold: false, color: INK, anchor, upwards: false, is_fixed: false }
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

    /// The same style on a raster, whose colours do not change on dark pages.
    #[must_use]
    pub const fn on_image(self) -> Self {
        Self { is_fixed: true, ..self }
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

    /// Writes a PNG, an SVG and a PDF and returns their paths: the stem, the part and the extension.
    ///
    /// # Errors
    /// [`ViewError::Draw`] when drawing fails, [`ViewError::File`] when a file cannot be written.
    pub fn save(&self, stem: &Path, part: &str) -> Result<Vec<PathBuf>, ViewError> {
        let failed = |reason: String| ViewError::draw(stem.display(), reason);
        let png = bitmap::png(self).map_err(|e| failed(e.0))?;
        let svg = svg::svg(self).map_err(|e| failed(e.to_string()))?.into_bytes();
        let pdf = pdf::pdf(self).map_err(failed)?;
        let write = |(extension, bytes): (&str, Vec<u8>)| {
            let mut name = stem.as_os_str().to_owned();
            name.push(part);
            name.push(extension);
            let path = PathBuf::from(name);
            write_bytes(&path, &bytes)?;
            Ok(path)
        };
        [(".png", png), (".svg", svg), (".pdf", pdf)].into_iter().map(write).collect()
    }

    /// The share of every pixel that a black drawing covers, 0 to 255, row by row, with one pixel per unit.
    ///
    /// # Errors
    /// [`ViewError::Draw`] when drawing fails.
    pub fn coverage(&self) -> Result<Vec<u8>, ViewError> {
        let pixels = bitmap::pixels(self, 1).map_err(|e| ViewError::draw("a drawing", e.0))?;
        Ok(pixels.chunks_exact(3).map(|p| 255 - p[1]).collect())
    }
}

/// Width and height of a raster on a drawing, in units.
fn in_units(image: &RgbaImage) -> [f64; 2] {
    [image.width(), image.height()].map(|side| f64::from(side) / f64::from(PIXELS_PER_UNIT))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drawing with one word on it.
    fn word(width: u32, height: u32) -> Canvas {
        let mut canvas = Canvas::new(width, height);
        canvas.text("word", (5.0, 15.0), TextStyle::NAME.at(Anchor::Left));
        canvas
    }

    #[test]
    fn all_files_have_the_size_of_the_canvas() {
        let folder = tempfile::tempdir().unwrap();
        let files = word(60, 30).save(&folder.path().join("a"), ".b").unwrap();
        assert_eq!(files, [".png", ".svg", ".pdf"].map(|end| folder.path().join(format!("a.b{end}"))));
        let png = png::Decoder::new(std::fs::File::open(&files[0]).unwrap()).read_info().unwrap();
        assert_eq!((png.info().width, png.info().height), (120, 60));
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert!(svg.contains("width=\"60\" height=\"30\" viewBox=\"0 0 60 30\""), "{svg}");
        let pdf = std::fs::read(&files[2]).unwrap();
        assert!(String::from_utf8_lossy(&pdf).contains("/MediaBox [0 0 30.24 15.12]"));
    }

    #[test]
    fn a_failing_drawing_is_an_error_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = word(0, 30).save(&folder.path().join("empty"), "").unwrap_err();
        assert!(matches!(error, ViewError::Draw { .. }), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }
}
