//! Drawings as pixels, by plotters.

use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontStyle, FontTransform, TextStyle as PlottersStyle, register_font};

use super::drawing::{Anchor, Canvas, Element, PIXELS_PER_UNIT, Point, TextStyle};
use crate::color::Rgb;
use crate::image::encode_png;

/// The PNG is drawn this many times finer and averaged, which smooths every edge.
const OVERSAMPLING: u32 = 2;

/// How far text moves down for its letters to be centred vertically, in ems.
const TEXT_DROP: f64 = 0.22;

const FONT: &str = "DejaVu Sans";

impl TextStyle {
    /// The style for plotters, with `pixels` per unit.
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

/// The bytes of a PNG file.
pub(super) fn png(canvas: &Canvas) -> Result<Vec<u8>, DrawError> {
    let (width, height) = (canvas.size.0 * PIXELS_PER_UNIT, canvas.size.1 * PIXELS_PER_UNIT);
    let pixels = pixels(canvas, PIXELS_PER_UNIT)?;
    encode_png(width, height, png::ColorType::Rgb, &pixels).map_err(|e| DrawError(e.to_string()))
}

/// RGB pixels, row by row, with `per_unit` per unit.
pub(super) fn pixels(canvas: &Canvas, per_unit: u32) -> Result<Vec<u8>, DrawError> {
    register_fonts()?;
    let fine = per_unit * OVERSAMPLING;
    let (width, height) = (canvas.size.0 * fine, canvas.size.1 * fine);
    let mut bytes = vec![255; width as usize * height as usize * 3];
    let area = BitMapBackend::with_buffer(&mut bytes, (width, height)).into_drawing_area();
    area.fill(&WHITE)?;
    for element in &canvas.elements {
        element.draw(&area, fine)?;
    }
    area.present()?;
    drop(area);
    Ok(average(&bytes, width as usize, OVERSAMPLING as usize))
}

impl Element {
    fn draw<DB: DrawingBackend>(&self, area: &DrawingArea<DB, Shift>, pixels: u32) -> Result<(), DrawError> {
        let px = |units: f64| (units * f64::from(pixels)).round() as i32;
        let at = |(x, y): Point| (px(x), px(y));
        match self {
            Self::Text { text, at: (x, y), style } => {
                let down = TEXT_DROP * f64::from(style.size);
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

/// Why drawing failed.
#[derive(Debug)]
pub(super) struct DrawError(pub(super) String);

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

    #[test]
    fn averaging_halves_an_image() {
        let row = [0, 10, 20, 100, 110, 121];
        assert_eq!(average(&[row, row].concat(), 2, 2), [50, 60, 71]);
    }
}
