//! Drawings by plotters, as PNG, SVG and PDF of the same content.
//!
//! Drawings are measured in **units**: [`PAGE_WIDTH`] of them are as wide as the text of a printed page (7 inches), so
//! a type size of 16 units prints at 8 points. plotters counts in whole pixels, of which a unit has [`PX`] in all files.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use base::files::write_bytes;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, register_font};

use super::pdf::{self, PdfBackend};
pub(super) use super::units::{LINE, PAGE_WIDTH, PICTURE_PX, PX, Picture};
use crate::color::{Rgb, class_color, class_color_on_dark, hex};
use crate::error::ReportError;
use crate::image::encode_png;

/// The background. Dark pages have other colours for it, for ink and for grid lines.
pub(crate) const PAPER: Rgb = [255; 3];
/// Text and lines.
pub(crate) const INK: Rgb = [34; 3];
/// Secondary text and axes.
pub(crate) const PALE_INK: Rgb = [105; 3];
/// Grid lines.
pub(crate) const GRID: Rgb = [228; 3];

/// Type size of tick labels and notes, in units.
pub(crate) const LABEL: f64 = 14.0;
/// Type size of names of axes.
pub(crate) const NAME: f64 = 16.0;
/// plotters places the name of a vertical axis this far beyond the area of its labels.
pub(crate) const NAME_MARGIN: f64 = 5.0;
/// Type size of titles.
pub(crate) const TITLE: f64 = 19.0;

/// The embedded font of the PNG and the PDF; for the SVG with fonts of similar width after it.
const FONT: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, sans-serif";

pub(crate) type Area<DB> = DrawingArea<DB, Shift>;
pub(crate) type Drawn<DB> = Result<(), DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

pub(crate) use plotters::prelude::BitMapBackend as Bitmap;

/// What plotters draws on any backend.
pub(crate) trait Drawing {
    /// Width and height, in units.
    fn size(&self) -> [i32; 2];
    /// The pictures under the drawing.
    fn pictures(&self) -> Result<Vec<Picture>, ReportError>;
    /// Draws what is not a picture.
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB>;
}

/// Pixels of a length in units.
pub(crate) fn px(units: f64) -> i32 {
    (units * f64::from(PX)).round() as i32
}

pub(crate) fn rgb([r, g, b]: Rgb) -> RGBColor {
    RGBColor(r, g, b)
}

/// The style of text of this size, in units, centred at its anchor.
pub(crate) fn text(size: f64, color: Rgb) -> TextStyle<'static> {
    scaled_text(size, color, PX)
}

/// The same for a unit of `px` pixels.
pub(crate) fn scaled_text(size: f64, color: Rgb, px: i32) -> TextStyle<'static> {
    let font = FontDesc::new(FontFamily::Name(FONT), size * f64::from(px) * LINE, FontStyle::Normal);
    font.color(&rgb(color)).pos(Pos::new(HPos::Center, VPos::Center))
}

/// The style in bold, from left to right.
pub(crate) fn bold(mut style: TextStyle<'static>) -> TextStyle<'static> {
    let size = style.font.get_size();
    style.font = FontDesc::new(FontFamily::Name(FONT), size, FontStyle::Bold);
    style
}

/// The style with the anchor at the left or right end of the text.
pub(crate) fn anchored(style: TextStyle<'static>, h: HPos) -> TextStyle<'static> {
    style.pos(Pos::new(h, VPos::Center))
}

/// The style for text that runs from bottom to top.
pub(crate) fn upwards(style: TextStyle<'static>) -> TextStyle<'static> {
    style.transform(FontTransform::Rotate270)
}

/// How far centred text moves down for its letters to be centred vertically, in pixels.
pub(crate) fn drop_of(style: &TextStyle<'_>) -> i32 {
    (0.19 * style.font.get_size()).round() as i32
}

/// Writes a text whose anchor is at half the height of its letters, in units.
pub(crate) fn write<DB: DrawingBackend>(
    area: &Area<DB>,
    text: &str,
    style: TextStyle<'static>,
    [x, y]: [f64; 2],
) -> Drawn<DB> {
    let drop = drop_of(&style);
    let is_level = matches!(style.font.get_transform(), FontTransform::None);
    let (right, down) = if is_level { (0, drop) } else { (drop, 0) };
    area.draw_text(text, &style, (px(x) + right, px(y) + down))
}

/// Draws a straight line of `width` units.
pub(crate) fn line<DB: DrawingBackend>(
    area: &Area<DB>,
    from: [f64; 2],
    to: [f64; 2],
    width: f64,
    color: Rgb,
) -> Drawn<DB> {
    let ends = [from, to].map(|[x, y]| (px(x), px(y)));
    area.draw(&PathElement::new(ends, rgb(color).stroke_width(px(width) as u32)))
}

/// Length of a text, in units of one pixel of `style`.
pub(crate) fn text_width(text: &str, style: &TextStyle<'_>) -> f64 {
    let measured = register_fonts().ok().and_then(|()| style.font.layout_box(text).ok());
    match measured {
        Some((_, (width, _))) => f64::from(width),
        // Without a font drawing fails; until then, a common proportion.
        None => 0.6 * style.font.get_size() * text.chars().count() as f64,
    }
}

/// Registers the embedded font: without a system library plotters has none of its own.
fn register_fonts() -> Result<(), ReportError> {
    static REGISTERED: OnceLock<bool> = OnceLock::new();
    let done = REGISTERED.get_or_init(|| {
        register_font(FONT, FontStyle::Normal, dejavu::sans::regular()).is_ok()
            && register_font(FONT, FontStyle::Bold, dejavu::sans::bold()).is_ok()
    });
    if *done { Ok(()) } else { Err(ReportError::draw("text", "the embedded font cannot be read")) }
}

/// Writes a PNG, an SVG and a PDF and returns their paths: the stem, the part and the extension.
pub(crate) fn save(drawing: &impl Drawing, stem: &Path, part: &str) -> Result<Vec<PathBuf>, ReportError> {
    register_fonts()?;
    let pictures = drawing.pictures()?;
    let failed = |reason: &dyn Display| ReportError::draw(stem.display(), reason);
    let files = [
        (".png", png(drawing, &pictures).map_err(|e| failed(&e))?),
        (".svg", svg(drawing, &pictures).map_err(|e| failed(&e))?),
        (".pdf", pdf(drawing, &pictures).map_err(|e| failed(&e))?),
    ];
    let write = |(extension, bytes): (&str, Vec<u8>)| {
        let mut name = stem.as_os_str().to_owned();
        name.push(part);
        name.push(extension);
        let path = PathBuf::from(name);
        write_bytes(&path, &bytes)?;
        Ok(path)
    };
    files.into_iter().map(write).collect()
}

fn png(drawing: &impl Drawing, pictures: &[Picture]) -> Result<Vec<u8>, String> {
    let [width, height] = drawing.size().map(|side| (side * PX) as u32);
    // Drawn finer and averaged, which smooths every edge.
    let fine = (PX / PICTURE_PX) as u32;
    let pixels = pixels([width, height], |area| {
        for (picture, [left, top]) in pictures {
            let size = (picture.width() * fine, picture.height() * fine);
            let place = (left * PX, top * PX);
            let raster = BitMapElement::with_owned_buffer(place, size, picture.rgb_bytes(fine));
            raster.map_or(Ok(()), |raster| area.draw(&raster))?;
        }
        drawing.draw(area)
    })?;
    let pixels = average(&pixels, width as usize, fine as usize);
    encode_png(width / fine, height / fine, png::ColorType::Rgb, &pixels).map_err(|e| e.to_string())
}

/// RGB pixels of a drawing on white, row by row.
pub(crate) fn pixels(
    [width, height]: [u32; 2],
    draw: impl FnOnce(&Area<Bitmap<'_>>) -> Drawn<Bitmap<'static>>,
) -> Result<Vec<u8>, String> {
    register_fonts().map_err(|e| e.to_string())?;
    let mut bytes = vec![255; width as usize * height as usize * 3];
    let area = BitMapBackend::with_buffer(&mut bytes, (width, height)).into_drawing_area();
    draw(&area).and_then(|()| area.present()).map_err(|e| e.to_string())?;
    drop(area);
    Ok(bytes)
}

/// Averages squares of `n` x `n` RGB pixels.
pub(crate) fn average(pixels: &[u8], width: usize, n: usize) -> Vec<u8> {
    let row = width * 3;
    let channel = |band: &[u8], at: usize| {
        let (column, channel) = (at / 3 * n, at % 3);
        let square = (0..n * n).map(|i| u32::from(band[i / n * row + (column + i % n) * 3 + channel]));
        ((square.sum::<u32>() + (n * n) as u32 / 2) / (n * n) as u32) as u8
    };
    let bands = pixels.chunks_exact((row * n).max(1));
    bands.flat_map(|band| (0..row / n).map(move |at| channel(band, at))).collect()
}

fn svg(drawing: &impl Drawing, pictures: &[Picture]) -> Result<Vec<u8>, String> {
    let [width, height] = drawing.size();
    let mut svg = String::new();
    let area =
        SVGBackend::with_string(&mut svg, ((width * PX) as u32, (height * PX) as u32)).into_drawing_area();
    let draw = || {
        area.fill(&WHITE)?;
        drawing.draw(&area)?;
        area.present()
    };
    draw().map_err(|e: DrawingAreaErrorKind<_>| e.to_string())?;
    drop(area);
    // As wide as the drawing, not as its pixels; text as far below its anchor as in the other files.
    let size = |scale: i32| format!("<svg width=\"{}\" height=\"{}\"", width * scale, height * scale);
    svg = svg.replacen(&size(PX), &size(1), 1);
    for (theirs, ours) in [("0.76em", pdf::TOP), ("0.5ex", pdf::CENTER), ("-0.5ex", pdf::BOTTOM)] {
        svg = svg.replace(&format!(" dy=\"{theirs}\""), &format!(" dy=\"{:.3}em\"", f64::from(ours) * 1.24));
    }
    // The background is the first element.
    let mut place = svg.find("/>\n").map_or(0, |end| end + 3);
    for (picture, [left, top]) in pictures {
        let data = picture.to_data_url().map_err(|e| e.to_string())?;
        let [wide, high] = [picture.width(), picture.height()].map(|side| side as i32 * PX / PICTURE_PX);
        let image = format!(
            "<image x=\"{}\" y=\"{}\" width=\"{wide}\" height=\"{high}\" href=\"{data}\"/>\n",
            left * PX,
            top * PX
        );
        svg.insert_str(place, &image);
        place += image.len();
    }
    Ok(svg.into_bytes())
}

fn pdf(drawing: &impl Drawing, pictures: &[Picture]) -> Result<Vec<u8>, String> {
    let mut page = pdf::Page::new(drawing.size(), pictures)?;
    drawing.draw(&PdfBackend(&mut page).into_drawing_area()).map_err(|e| e.to_string())?;
    page.finish()
}

/// An SVG with a style that gives it the colours of dark pages if the reader prefers those, except in print.
pub(crate) fn dark(svg: &str) -> String {
    let colors = [
        (PAPER, [20, 23, 26]),
        (INK, [228, 231, 234]),
        (PALE_INK, [163, 171, 181]),
        (GRID, [53, 59, 66]),
        (class_color(6), class_color_on_dark(6)),
    ];
    let rule = |(light, dark): (Rgb, Rgb)| {
        let [light, dark] = [light, dark].map(|color| hex(color).to_uppercase());
        format!("[fill=\"{light}\"]{{fill:{dark}}}[stroke=\"{light}\"]{{stroke:{dark}}}")
    };
    let style = format!(
        "<style>@media screen and (prefers-color-scheme:dark){{{}}}</style>",
        colors.map(rule).concat()
    );
    svg.replacen('>', &format!(">{style}"), 1)
}
