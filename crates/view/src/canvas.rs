//! One drawing, two files: the same plotters calls make a PNG and an SVG.
//!
//! Drawings are laid out in whole **units**, 1000 of them as wide as a printed page's text (7 inches), so
//! that a type size of 16 units prints at 8 points. Backends draw at a whole number of pixels a unit.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, FontTransform, register_font};

use files::write_bytes;

use crate::image::encode_png;
use crate::{RgbaImage, ViewError};

/// Pixels a unit of both files, and of every raster inside them: 286 dots per inch in print.
pub const RASTER: u32 = 2;

/// The PNG is drawn this many times finer and averaged, which smooths every edge.
const OVERSAMPLING: u32 = 2;

/// Name under which the embedded DejaVu Sans is registered. It is also what the SVG asks its viewer for, so it
/// lists stand-ins of similar width.
const FONT: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, sans-serif";

/// Plain text, axis labels.
pub const TEXT: u32 = 16;
/// Notes, tick labels.
pub const SMALL: u32 = 14;
/// Titles of panels.
pub const TITLE: u32 = 19;

/// Text and lines.
pub const INK: RGBColor = RGBColor(34, 34, 34);
/// Secondary text and frames.
pub const PALE_INK: RGBColor = RGBColor(105, 105, 105);
/// Grid lines.
pub const GRID: RGBColor = RGBColor(228, 228, 228);

/// Why a backend stopped, as text: the error types of the two backends have nothing else in common.
#[derive(Debug)]
pub struct DrawError(String);

impl DrawError {
    /// What the backend said.
    #[must_use]
    pub fn reason(self) -> String {
        self.0
    }
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for DrawError {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self(error.to_string())
    }
}

/// Something that can be drawn by any backend.
pub trait Drawing {
    /// Width and height, in units.
    fn size(&self) -> (u32, u32);

    /// Draws everything.
    fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError>;
}

/// Writes `stem.png` and `stem.svg` (the extensions are appended to the stem) and returns their paths.
pub fn save(drawing: &impl Drawing, stem: &Path) -> Result<Vec<PathBuf>, ViewError> {
    let failed = |reason: String| ViewError::Draw { figure: stem.display().to_string(), reason };
    register_fonts().map_err(|e| failed(e.0))?;
    let path = |extension: &str| {
        let mut name = stem.as_os_str().to_owned();
        name.push(extension);
        PathBuf::from(name)
    };
    let (png, svg) = (path(".png"), path(".svg"));
    write_bytes(&png, &png_bytes(drawing).map_err(|e| failed(e.0))?)?;
    write_bytes(&svg, svg_text(drawing).map_err(|e| failed(e.0))?.as_bytes())?;
    Ok(vec![png, svg])
}

/// plotters has no font of its own without a system library: both backends fail until one is registered.
fn register_fonts() -> Result<(), DrawError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let done = REGISTERED.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok()
            && register_font(FONT, FontStyle::Bold, dejavu::sans::bold()).is_ok()
    });
    if *done { Ok(()) } else { Err(DrawError("the embedded font cannot be read".into())) }
}

/// The share of every pixel that the ink of a drawing in black covers, 0 to 255, row by row; a pixel a unit.
pub fn ink(drawing: &impl Drawing) -> Result<Vec<u8>, DrawError> {
    register_fonts()?;
    let (width, height) = drawing.size();
    let (wide, high) = (width * OVERSAMPLING, height * OVERSAMPLING);
    let mut pixels = vec![255; wide as usize * high as usize * 3];
    draw_on(drawing, BitMapBackend::with_buffer(&mut pixels, (wide, high)), OVERSAMPLING, 0.22)?;
    let pixels = average(&pixels, wide as usize, OVERSAMPLING as usize);
    Ok(pixels.chunks_exact(3).map(|p| 255 - p[1]).collect())
}

fn png_bytes(drawing: &impl Drawing) -> Result<Vec<u8>, DrawError> {
    let (width, height) = drawing.size();
    let fine = RASTER * OVERSAMPLING;
    let mut pixels = vec![255; (width * fine * height * fine * 3) as usize];
    let backend = BitMapBackend::with_buffer(&mut pixels, (width * fine, height * fine));
    draw_on(drawing, backend, fine, 0.22)?;
    let pixels = average(&pixels, (width * fine) as usize, OVERSAMPLING as usize);
    encode_png(width * RASTER, height * RASTER, png::ColorType::Rgb, &pixels)
        .map_err(|e| DrawError(e.to_string()))
}

fn svg_text(drawing: &impl Drawing) -> Result<String, DrawError> {
    let (width, height) = drawing.size();
    let (wide, high) = (width * RASTER, height * RASTER);
    let mut svg = String::new();
    draw_on(drawing, SVGBackend::with_string(&mut svg, (wide, high)), RASTER, 0.06)?;
    // The backend writes the size in pixels, where a unit is meant, and a media type that is none.
    let svg = svg.replacen(
        &format!("width=\"{wide}\" height=\"{high}\""),
        &format!("width=\"{width}\" height=\"{height}\""),
        1,
    );
    Ok(svg.replace("\"data:png;base64,", "\"data:image/png;base64,"))
}

fn draw_on<DB: DrawingBackend>(
    drawing: &impl Drawing,
    backend: DB,
    pixels: u32,
    text_drop: f64,
) -> Result<(), DrawError> {
    let area = backend.into_drawing_area();
    area.fill(&WHITE)?;
    drawing.draw(&Canvas { area: area.clone(), pixels, text_drop })?;
    Ok(area.present()?)
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

/// A rectangle of the drawing, measured in units from its own top left corner.
pub struct Canvas<DB: DrawingBackend> {
    area: DrawingArea<DB, Shift>,
    pixels: u32,
    /// How far below the place that the backend writes at a text has to go, in ems, for its letters to
    /// be centred there: backends disagree on what the middle of a text is.
    text_drop: f64,
}

/// Where a text's anchor point lies on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// Its left end.
    Left,
    /// Its middle.
    Center,
    /// Its right end.
    Right,
}

/// Which way a text runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Run {
    /// Left to right.
    Level,
    /// Bottom to top.
    Up,
}

/// How a text looks; its anchor point is always at half its height.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Type {
    /// Size of the type, in units.
    pub size: u32,
    /// Whether it is bold.
    pub bold: bool,
    /// Its colour.
    pub color: RGBColor,
    /// Where the anchor point lies on it.
    pub anchor: Anchor,
    /// Which way it runs.
    pub run: Run,
}

impl Type {
    /// Plain text from left to right in ink.
    #[must_use]
    pub const fn new(size: u32, anchor: Anchor) -> Self {
        Self { size, bold: false, color: INK, anchor, run: Run::Level }
    }

    /// The same in bold.
    #[must_use]
    pub fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// The same in pale ink.
    #[must_use]
    pub fn pale(self) -> Self {
        Self { color: PALE_INK, ..self }
    }

    /// The same from bottom to top.
    #[must_use]
    pub fn up(self) -> Self {
        Self { run: Run::Up, ..self }
    }
}

impl<DB: DrawingBackend> Canvas<DB> {
    /// The plotters area behind it, for charts.
    pub fn area(&self) -> &DrawingArea<DB, Shift> {
        &self.area
    }

    /// Backend pixels of a length in units.
    pub fn px(&self, units: f64) -> i32 {
        (units * f64::from(self.pixels)).round() as i32
    }

    /// The part of the canvas at `corner`, of `size`.
    pub fn part(&self, corner: (f64, f64), size: (f64, f64)) -> Self {
        let (left, top) = (self.px(corner.0), self.px(corner.1));
        let area = self.area.clone().shrink((left, top), (self.px(size.0), self.px(size.1)));
        Self { area, pixels: self.pixels, text_drop: self.text_drop }
    }

    /// Writes a text with its anchor at `at`, on half the height of its letters.
    pub fn text(&self, text: &str, at: (f64, f64), kind: Type) -> Result<(), DrawError> {
        let down = self.text_drop * f64::from(kind.size);
        let (x, y) = match kind.run {
            Run::Level => (at.0, at.1 + down),
            Run::Up => (at.0 + down, at.1),
        };
        self.area.draw_text(text, &style(kind, self.pixels), (self.px(x), self.px(y)))?;
        Ok(())
    }

    /// Draws a raster of [`RASTER`] pixels a unit with its top left corner at `at`.
    pub fn image(&self, image: &RgbaImage, at: (f64, f64)) -> Result<(), DrawError> {
        let zoom = self.pixels / RASTER;
        let size = (image.width() * zoom, image.height() * zoom);
        let corner = (self.px(at.0), self.px(at.1));
        let Some(element) = BitMapElement::with_owned_buffer(corner, size, image.rgb_bytes(zoom)) else {
            return Err(DrawError("a raster is smaller than it says".into()));
        };
        self.area.draw(&element)?;
        Ok(())
    }

    /// A straight line of `width` units.
    pub fn line(
        &self,
        from: (f64, f64),
        to: (f64, f64),
        width: f64,
        color: RGBColor,
    ) -> Result<(), DrawError> {
        let ends = [from, to].map(|(x, y)| (self.px(x), self.px(y)));
        self.area.draw(&PathElement::new(ends, color.stroke_width(self.px(width).max(1) as u32)))?;
        Ok(())
    }
}

/// A plotters text style of the registered font, for backends with `pixels` a unit.
pub fn style(kind: Type, pixels: u32) -> TextStyle<'static> {
    // plotters sizes a font by its line; type is measured by its em, 1.164 of which DejaVu needs for a line.
    let size = f64::from(kind.size * pixels) * 1.164;
    let style = if kind.bold { FontStyle::Bold } else { FontStyle::Normal };
    let font = FontDesc::new(FontFamily::Name(FONT), size, style);
    let font = match kind.run {
        Run::Level => font,
        Run::Up => font.transform(FontTransform::Rotate270),
    };
    let h = match kind.anchor {
        Anchor::Left => HPos::Left,
        Anchor::Center => HPos::Center,
        Anchor::Right => HPos::Right,
    };
    TextStyle { font, color: kind.color.to_backend_color(), pos: Pos::new(h, VPos::Center) }
}

/// Length of a text, in units.
pub fn text_width(text: &str, kind: Type) -> f64 {
    // Measured large, as the backend rounds to whole pixels.
    const FINE: u32 = 8;
    let measured = register_fonts().ok().and_then(|()| style(kind, FINE).font.layout_box(text).ok());
    match measured {
        Some((_, (width, _))) => f64::from(width) / f64::from(FINE),
        // No font, no figure: saving reports it. A common proportion does until then.
        None => 0.6 * f64::from(kind.size) * text.chars().count() as f64,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widths_follow_the_text() {
        let kind = Type::new(TEXT, Anchor::Left);
        assert_eq!(text_width("", kind), 0.0);
        let digit = text_width("0", kind);
        assert!(
            (digit / f64::from(TEXT) - 0.636).abs() < 0.02,
            "a digit of DejaVu Sans is 0.636 em wide: {digit}"
        );
        assert!((text_width("0000", kind) - 4.0 * digit).abs() < 0.5);
        assert!(text_width("wide", kind.bold()) > text_width("wide", kind));
    }

    /// A drawing of any size with one word on it.
    struct Word((u32, u32));

    impl Drawing for Word {
        fn size(&self) -> (u32, u32) {
            self.0
        }

        fn draw<DB: DrawingBackend>(&self, canvas: &Canvas<DB>) -> Result<(), DrawError> {
            canvas.text("word", (5.0, 15.0), Type::new(TEXT, Anchor::Left))
        }
    }

    #[test]
    fn both_files_have_the_size_asked_for() {
        let folder = tempfile::tempdir().unwrap();
        let files = save(&Word((60, 30)), &folder.path().join("a.b")).unwrap();
        assert_eq!(files, [folder.path().join("a.b.png"), folder.path().join("a.b.svg")]);
        let png = png::Decoder::new(std::fs::File::open(&files[0]).unwrap()).read_info().unwrap();
        assert_eq!((png.info().width, png.info().height), (120, 60));
        let svg = std::fs::read_to_string(&files[1]).unwrap();
        assert!(svg.starts_with("<svg width=\"60\" height=\"30\" viewBox=\"0 0 120 60\""), "{svg}");
    }

    #[test]
    fn a_backend_that_fails_is_an_error_and_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let error = save(&Word((0, 30)), &folder.path().join("empty")).unwrap_err();
        assert!(matches!(error, ViewError::Draw { .. }), "{error}");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn averaging_halves_a_picture() {
        let row = [0, 10, 20, 100, 110, 121];
        assert_eq!(average(&[row, row].concat(), 2, 2), [50, 60, 71]);
    }
}
