//! What an image shows and how.

use super::camera::View;
use super::coloring::Coloring;
use crate::color::ColorMap;

/// Options of [`render`](super::render). Every value is usable: sizes are clamped to the stated ranges.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Width in pixels, clamped to 1..=8192. Default: 600.
    pub width: u32,
    /// Height in pixels, clamped to 1..=8192. Default: 600.
    pub height: u32,
    /// Direction of the view. Default: [`View::default`].
    pub view: View,
    /// What is behind the surface. Default: [`Background::WHITE`].
    pub background: Background,
    /// Colors of the surface. Default: a light clay.
    pub coloring: Coloring,
    /// The sRGB colors of the last vertices of the mesh, which are those of marks on the surface, such as paths. Default: none.
    pub marks: Vec<[u8; 3]>,
    /// The colors of numbers. Default: [`ColorMap::Viridis`].
    pub colors: ColorMap,
    /// Dihedral angle in degrees, clamped to 0..=90, above which an edge is shaded as a crease. Default: 80.
    pub crease: f64,
    /// Samples along each side of a pixel, clamped to 1..=4. Default: 3, nine samples per pixel.
    pub supersampling: u32,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 600,
            height: 600,
            view: View::default(),
            background: Background::WHITE,
            coloring: Coloring::Plain([214, 206, 194]),
            marks: Vec::new(),
            colors: ColorMap::default(),
            crease: 80.0,
            supersampling: 3,
        }
    }
}

impl RenderOptions {
    /// Width and height, clamped.
    pub(super) fn size(&self) -> [u32; 2] {
        [self.width, self.height].map(|side| side.clamp(1, 8192))
    }
}

/// What is behind the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// An opaque sRGB color.
    Color([u8; 3]),
    /// Alpha 0; at edges, alpha is the covered share of the pixel.
    Transparent,
}

impl Background {
    /// Opaque white.
    pub const WHITE: Self = Self::Color([255; 3]);
}
