//! The elements of a drawing.

use crate::color::Rgb;
use crate::image::RgbaImage;

/// Pixels per unit of the PNG and of every raster: 286 dots per inch in print.
pub const PIXELS_PER_UNIT: u32 = 2;

/// Width of a figure that fills the text of a page, in units.
pub const PAGE_WIDTH: f64 = 1000.0;

/// From the middle of a text down to its baseline, in ems.
pub(super) const DROP: f64 = 0.33;

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
    pub(super) size: u32,
    pub(super) bold: bool,
    pub(super) color: Rgb,
    pub(super) anchor: Anchor,
    pub(super) upwards: bool,
    /// Whether dark pages keep the colour.
    pub(super) is_fixed: bool,
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
    pub(super) size: (u32, u32),
    pub(super) elements: Vec<Element>,
}

#[derive(Debug, Clone)]
pub(super) enum Element {
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
}

/// Width and height of a raster on a drawing, in units.
pub(super) fn in_units(image: &RgbaImage) -> [f64; 2] {
    [image.width(), image.height()].map(|side| f64::from(side) / f64::from(PIXELS_PER_UNIT))
}
