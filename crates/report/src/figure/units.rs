//! Units in which drawings are measured.

use crate::image::RgbaImage;

/// Pixels of plotters per unit.
pub(crate) const PX: i32 = 4;
/// Pixels per unit of a [`Picture`] and of the PNG: 286 dots per inch in print.
pub(crate) const PICTURE_PX: i32 = 2;
/// Width of a figure that fills the text of a page, in units.
pub(crate) const PAGE_WIDTH: i32 = 1000;

/// plotters measures a font by its line, which is 1.164 em in DejaVu.
pub(super) const LINE: f64 = 1.164;
/// A raster of [`PICTURE_PX`], and its top left corner in units.
pub(crate) type Picture = (RgbaImage, [i32; 2]);
