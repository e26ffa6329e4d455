//! Text over images: labels of points, and pictures with titles in one image.

use base::Budget;
use mesh::TriMesh;
use nalgebra::Point3;

use super::camera::{Camera, drawable};
use super::options::{Background, RenderOptions};
use super::raster::DepthBuffer;
use crate::color::{Rgb, mix, to_linear};
use crate::error::ReportError;
use crate::figure::{Area, Bitmap, Drawn, INK, average, drop_of, pixels, scaled_text, text_width};
use crate::image::RgbaImage;

/// A point of a mesh, and the text at it.
pub type Label = ([f64; 3], String);

/// A text in an image: its middle, in pixels from the left and the top, and its greatest width. It is written smaller to fit.
pub type Title = (String, [f64; 2], f64);

/// Places pictures, given by their top left corners, and then titles of this type size in an image of this size. Pictures beyond
/// the image are cut off.
///
/// # Errors
/// [`ReportError::Draw`] if text cannot be written.
pub fn collage(
    [width, height]: [u32; 2],
    background: Background,
    pictures: &[(RgbaImage, [i64; 2])],
    (titles, size): (&[Title], f64),
) -> Result<RgbaImage, ReportError> {
    let mut image = RgbaImage::new(width, height, empty(background));
    for (picture, [left, top]) in pictures {
        for (i, pixel) in picture.pixels().iter().enumerate() {
            let (column, row) = (i as u32 % picture.width(), i as u32 / picture.width());
            let place = [left + i64::from(column), top + i64::from(row)].map(u32::try_from);
            if let [Ok(x), Ok(y)] = place
                && x < width
                && y < height
            {
                let below = &mut image.pixels_mut()[y as usize * width as usize + x as usize];
                *below = over(*below, [pixel[0], pixel[1], pixel[2]], f64::from(pixel[3]) / 255.0);
            }
        }
    }
    let texts = titles.iter().map(|(text, middle, width)| {
        (text.as_str(), *middle, (width / width_of(text, size)).min(1.0) * size)
    });
    write(&mut image, background, &texts.collect::<Vec<_>>(), 0.0)?;
    Ok(image)
}

/// Writes labels beside those points of a mesh that are seen with these options: none over another or over a labelled point, as
/// far as there is room, and all inside the image.
pub(super) fn write_labels(
    image: &mut RgbaImage,
    mesh: &TriMesh,
    options: &RenderOptions,
    labels: &[Label],
    budget: &Budget,
) -> Result<(), ReportError> {
    if labels.is_empty() {
        return Ok(());
    }
    let (size, mesh) = ([image.width(), image.height()], drawable(mesh));
    let camera = Camera::fit(&mesh, &options.view, size);
    let nearest = DepthBuffer::draw(&mesh, &camera, size, budget)?;
    let em = type_size(size);
    let seen = |(at, text): &'_ Label| {
        let [x, y, depth] = camera.project(&Point3::from(*at));
        let [column, row] = [x, y].map(|at| at.max(0.0) as usize);
        let is_inside = column < nearest.size[0] && row < nearest.size[1];
        // Points lie on the surface, or are the middles of dots on it.
        let is_seen = !is_inside || f64::from(nearest.depth[row * nearest.size[0] + column]) <= depth + em;
        is_seen.then(|| ([x, y], width_of(text, em)))
    };
    let seen: Vec<_> = labels.iter().filter_map(|label| Some((seen(label)?, &label.1))).collect();
    let (points, widths): (Vec<[f64; 2]>, Vec<f64>) = seen.iter().map(|(place, _)| *place).unzip();
    let middles = beside(&points, &widths, em, size.map(f64::from));
    let texts = seen.iter().zip(middles).map(|((_, text), middle)| (text.as_str(), middle, em));
    write(image, options.background, &texts.collect::<Vec<_>>(), em / 6.0)
}

/// The middles of texts of these widths beside points.
fn beside(points: &[[f64; 2]], widths: &[f64], em: f64, size: [f64; 2]) -> Vec<[f64; 2]> {
    // To the upper right first, as in maps.
    const SIDES: [[f64; 2]; 8] =
        [[1., -1.], [1., 1.], [-1., -1.], [-1., 1.], [0., -1.], [0., 1.], [1., 0.], [-1., 0.]];
    let mut taken: Vec<[[f64; 2]; 2]> = points.iter().map(|point| [*point, [0.4 * em; 2]]).collect();
    let mut middles = Vec::with_capacity(points.len());
    for (point, width) in points.iter().zip(widths) {
        let half = [0.5 * width + 0.2 * em, 0.6 * em];
        let at = |side: &[f64; 2]| {
            let axis = |i: usize| {
                let aside = point[i] + side[i] * (half[i] + 0.5 * em);
                aside.min(size[i] - half[i]).max(half[i])
            };
            [axis(0), axis(1)]
        };
        let is_free = |middle: &[f64; 2]| {
            let meets = |[other, extent]: &[[f64; 2]; 2]| {
                (0..2).all(|i| (middle[i] - other[i]).abs() < half[i] + extent[i])
            };
            !taken.iter().any(meets)
        };
        let middle = SIDES.iter().map(at).find(is_free).unwrap_or_else(|| at(&SIDES[0]));
        taken.push([middle, half]);
        middles.push(middle);
    }
    middles
}

/// The type size in an image of this size, in pixels.
pub(super) fn type_size(size: [u32; 2]) -> f64 {
    (f64::from(size[0].min(size[1])) / 36.0).clamp(11.0, 64.0).round()
}

/// The width of a text in pixels.
pub(super) fn width_of(text: &str, size: f64) -> f64 {
    // Measured large, as plotters rounds to whole pixels.
    text_width(text, &scaled_text(size, INK, 8)) / 8.0
}

/// Writes texts by their middles and sizes, on a margin of the background of this width.
fn write(
    image: &mut RgbaImage,
    background: Background,
    texts: &[(&str, [f64; 2], f64)],
    margin: f64,
) -> Result<(), ReportError> {
    // Letters are placed at whole pixels: drawn finer and averaged, they are as far apart as they should be.
    let n_pixels = f64::from(image.width()) * f64::from(image.height());
    let scale = (MOST_FINE / n_pixels).sqrt().clamp(1.0, 4.0) as u32;
    paint(image, background, (margin, scale), "text", |area| {
        for (text, [x, y], size) in texts {
            let style = scaled_text(*size, INK, scale as i32);
            let [x, y] = [x, y].map(|at| (at * f64::from(scale)).round() as i32);
            area.draw_text(text, &style, (x, y + drop_of(&style)))?;
        }
        Ok(())
    })
}

/// Most pixels of a drawing that is averaged: 200 MB.
const MOST_FINE: f64 = 6.4e7;

/// Paints what is drawn in [`INK`], with this many pixels to a side of each of the image, in a color that contrasts with the
/// background, on a margin of this width.
pub(super) fn paint(
    image: &mut RgbaImage,
    background: Background,
    (margin, scale): (f64, u32),
    what: &str,
    draw: impl FnOnce(&Area<Bitmap<'_>>) -> Drawn<Bitmap<'static>>,
) -> Result<(), ReportError> {
    let (width, height) = (image.width() as usize, image.height() as usize);
    let drawn = pixels([image.width() * scale, image.height() * scale], draw);
    let drawn = drawn.map_err(|reason| ReportError::draw(what, reason))?;
    let drawn = average(&drawn, width * scale as usize, scale as usize);
    // Drawn dark on white: the darker a pixel, the more of it is covered.
    let cover: Vec<f64> =
        drawn.chunks_exact(3).map(|pixel| f64::from(255 - pixel[1]) / f64::from(255 - INK[1])).collect();
    let mut around = vec![0.0_f64; cover.len()];
    let reach = margin.ceil() as usize;
    for (i, share) in cover.iter().enumerate().filter(|(_, share)| reach > 0 && **share > 0.0) {
        let (x, y) = (i % width, i / width);
        for row in y.saturating_sub(reach)..(y + reach + 1).min(height) {
            for column in x.saturating_sub(reach)..(x + reach + 1).min(width) {
                let apart = (row as f64 - y as f64).hypot(column as f64 - x as f64);
                let near = &mut around[row * width + column];
                *near = near.max(share * (margin + 0.5 - apart).clamp(0.0, 1.0));
            }
        }
    }
    // On a margin, text is on white where nothing is behind the surface.
    let background = match background {
        Background::Transparent if reach > 0 => Background::WHITE,
        background => background,
    };
    let [r, g, b, _] = empty(background);
    for ((pixel, near), share) in image.pixels_mut().iter_mut().zip(around).zip(cover) {
        *pixel = over(over(*pixel, [r, g, b], 0.85 * near), pen(background), share);
    }
    Ok(())
}

/// A pixel without a surface.
pub(super) fn empty(background: Background) -> [u8; 4] {
    match background {
        Background::Color([r, g, b]) => [r, g, b, 255],
        Background::Transparent => [0; 4],
    }
}

/// A text color that contrasts with the background.
fn pen(background: Background) -> Rgb {
    let light = match background {
        // As far from white as from black.
        Background::Transparent => return [118; 3],
        Background::Color(color) => {
            let [r, g, b] = color.map(to_linear);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        }
    };
    if light > 0.18 { [34; 3] } else { [235; 3] }
}

/// A pixel of which an opaque color covers `share`.
fn over([r, g, b, alpha]: [u8; 4], color: Rgb, share: f64) -> [u8; 4] {
    if share <= 0.0 {
        return [r, g, b, alpha];
    }
    let below = f64::from(alpha) / 255.0 * (1.0 - share);
    let whole = below + share;
    let [r, g, b] = mix([r, g, b], color, share / whole);
    [r, g, b, (whole * 255.0).round() as u8]
}
