//! Drawings by plotters, as SVG.
//!
//! Drawings are measured in **units**: [`PAGE_WIDTH`] of them are as wide as the text of a printed page (7 inches), so
//! a type size of 16 units prints at 8 points. plotters counts in whole pixels, of which a unit has [`PX`].

use std::sync::OnceLock;

use plotters::coord::Shift;
use plotters::coord::ranged1d::ValueFormatter;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, register_font};

use super::axis::PlotAxis;
use crate::color::{Rgb, class_color, hex};
use crate::error::ReportError;
use crate::image::RgbaImage;
use crate::markup::escape;

/// Pixels of plotters per unit.
pub(crate) const PX: i32 = 4;
/// Pixels per unit of a [`Picture`]: 286 dots per inch in print.
pub(crate) const PICTURE_PX: i32 = 2;
/// Width of a figure that fills the text of a page, in units.
pub(crate) const PAGE_WIDTH: i32 = 1000;

/// plotters measures a font by its line, which is 1.164 em in DejaVu.
const LINE: f64 = 1.164;

/// A raster of [`PICTURE_PX`], and its top left corner in units.
pub(crate) type Picture = (RgbaImage, [i32; 2]);

/// A place of a drawing in pixels, and what the page says when the reader points at it.
pub(crate) type Hover = ((i32, i32), String);

/// The background. Dark pages have other colors for it, for ink and for grid lines.
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

/// The embedded font, which measures text; in the SVG with fonts of similar width after it.
const FONT: &str = "DejaVu Sans, Bitstream Vera Sans, Verdana, sans-serif";

pub(crate) type Area<DB> = DrawingArea<DB, Shift>;
pub(crate) type Drawn<DB, T = ()> = Result<T, DrawingAreaErrorKind<<DB as DrawingBackend>::ErrorType>>;

pub(crate) use plotters::prelude::BitMapBackend as Bitmap;

/// What plotters draws on any backend.
pub(crate) trait Drawing {
    /// Width and height, in units.
    fn size(&self) -> [i32; 2];
    /// The pictures under the drawing.
    fn pictures(&self) -> Result<Vec<Picture>, ReportError> {
        Ok(vec![])
    }
    /// Draws what is not a picture, and returns what it says on hover.
    fn draw<DB: DrawingBackend>(&self, area: &Area<DB>) -> Drawn<DB, Vec<Hover>>;
}

/// Pixels of a length in units.
pub(crate) fn px(units: f64) -> i32 {
    (units * f64::from(PX)).round() as i32
}

pub(crate) fn rgb([r, g, b]: Rgb) -> RGBColor {
    RGBColor(r, g, b)
}

/// The style of text of this size, in units, centered at its anchor.
pub(crate) fn text(size: f64, color: Rgb) -> TextStyle<'static> {
    scaled_text(size, color, PX)
}

/// The same for a unit of `px` pixels.
pub(crate) fn scaled_text(size: f64, color: Rgb, px: i32) -> TextStyle<'static> {
    let font = FontDesc::new(FontFamily::Name(FONT), size * f64::from(px) * LINE, FontStyle::Normal);
    font.color(&rgb(color)).pos(Pos::new(HPos::Center, VPos::Center))
}

/// The style in bold.
pub(crate) fn bold(style: TextStyle<'static>) -> TextStyle<'static> {
    TextStyle { font: style.font.style(FontStyle::Bold), ..style }
}

/// The style with the anchor at the left or right end of the text.
pub(crate) fn anchored(style: TextStyle<'static>, h: HPos) -> TextStyle<'static> {
    style.pos(Pos::new(h, VPos::Center))
}

/// The style for text that runs from bottom to top.
pub(crate) fn upwards(style: TextStyle<'static>) -> TextStyle<'static> {
    style.transform(FontTransform::Rotate270)
}

/// How far centered text moves down for its letters to be centered vertically, in pixels.
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

/// Draws the ticks and the name of a color bar of this thickness at the left of an area, with `scale` pixels per unit.
pub(crate) fn bar_labels<DB: DrawingBackend>(
    area: &Area<DB>,
    axis: &PlotAxis,
    thickness: f64,
    size: f64,
    scale: i32,
) -> Drawn<DB> {
    let label = scaled_text(size, INK, scale);
    let thickness = (thickness * f64::from(scale)) as u32;
    let (width, _) = area.dim_in_pixel();
    let mut chart = ChartBuilder::on(area)
        .right_y_label_area_size(width.saturating_sub(thickness))
        .build_cartesian_2d(0.0..1.0, axis.clone())?;
    let format = |tick: &f64| axis.format_ext(tick);
    let mut mesh = chart.configure_mesh();
    mesh.disable_mesh().axis_style(rgb(INK).stroke_width(scale.max(1) as u32));
    mesh.set_all_tick_mark_size((0.3 * size * f64::from(scale)) as i32).y_label_offset(drop_of(&label));
    mesh.label_style(label.clone()).axis_desc_style(label).y_label_formatter(&format).y_desc(&axis.name);
    mesh.draw()
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

/// The text of a drawing as SVG.
pub(crate) fn svg(drawing: &impl Drawing) -> Result<String, String> {
    register_fonts().map_err(|e| e.to_string())?;
    let pictures = drawing.pictures().map_err(|e| e.to_string())?;
    let [width, height] = drawing.size();
    let mut svg = String::new();
    let area =
        SVGBackend::with_string(&mut svg, ((width * PX) as u32, (height * PX) as u32)).into_drawing_area();
    let drawn = area.fill(&WHITE).and_then(|()| drawing.draw(&area));
    let drawn = drawn.and_then(|hovers| area.present().map(|()| hovers));
    let hovers = drawn.map_err(|e| e.to_string())?;
    drop(area);
    // As wide as the drawing, not as its pixels; text as far below its anchor as on bitmaps.
    let size = |scale: i32| format!("<svg width=\"{}\" height=\"{}\"", width * scale, height * scale);
    svg = svg.replacen(&size(PX), &size(1), 1);
    for (theirs, ours) in [("0.76em", "0.620em"), ("0.5ex", "0.120em"), ("-0.5ex", "-0.379em")] {
        svg = svg.replace(&format!(" dy=\"{theirs}\""), &format!(" dy=\"{ours}\""));
    }
    // The background is the first element.
    let mut place = svg.find("/>\n").map_or(0, |end| end + 3);
    for (picture, [left, top]) in pictures {
        let data = picture.to_data_url().map_err(|e| e.to_string())?;
        let [x, y] = [left, top].map(|at| at * PX);
        let [wide, high] = [picture.width(), picture.height()].map(|side| side as i32 * PX / PICTURE_PX);
        let image =
            format!("<image x=\"{x}\" y=\"{y}\" width=\"{wide}\" height=\"{high}\" href=\"{data}\"/>\n");
        svg.insert_str(place, &image);
        place += image.len();
    }
    let end = svg.rfind("</svg>").unwrap_or(svg.len());
    let place = |((x, y), text): Hover| {
        let text = escape(&text);
        format!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"32\" fill=\"transparent\"><title>{text}</title></circle>\n"
        )
    };
    svg.insert_str(end, &hovers.into_iter().map(place).collect::<String>());
    Ok(svg)
}

/// Rules of CSS that give drawings the colors of dark pages.
pub(crate) fn dark_rules() -> String {
    let colors = [
        (PAPER, [20, 23, 26]),
        (INK, [228, 231, 234]),
        (PALE_INK, [163, 171, 181]),
        (GRID, [53, 59, 66]),
        // The darkest of the colors of classes.
        (class_color(6), [201, 204, 209]),
    ];
    let rule = |(light, dark): (Rgb, Rgb)| {
        let [light, dark] = [light, dark].map(|color| hex(color).to_uppercase());
        format!("svg [fill=\"{light}\"]{{fill:{dark}}}svg [stroke=\"{light}\"]{{stroke:{dark}}}")
    };
    colors.map(rule).concat()
}
