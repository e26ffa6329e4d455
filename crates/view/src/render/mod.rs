//! Shaded pictures of triangle meshes, drawn in software: no window, no graphics card, no system
//! library.
//!
//! The mesh is turned into the picture ([`View`]), its triangles are drawn into a depth buffer finer
//! than the picture, every visible sample is lit, and the samples of a pixel are averaged in linear
//! light. The same mesh and options give the same bytes.

mod bar;
mod camera;
mod dots;
mod normals;
mod raster;
mod shade;

pub use bar::render_with_bar;
pub use camera::View;
pub use dots::dots;

use mesh::TriMesh;
use nalgebra::Vector3;

use crate::RgbaImage;
use crate::color::{perceptual, to_linear};
use camera::Camera;
use raster::DepthBuffer;

/// Options of [`render`]. Nothing here can make it fail: sizes are clamped as stated.
#[derive(Debug, Clone, PartialEq)]
pub struct RenderOptions {
    /// Columns of pixels, clamped to 1..=8192. Default: 600.
    pub width: u32,
    /// Rows of pixels, clamped to 1..=8192. Default: 600.
    pub height: u32,
    /// Empty border, as a share of the shorter side, clamped to 0..=0.45. Default: 0.04.
    pub margin: f64,
    /// Where the viewer stands. Default: [`View::default`].
    pub view: View,
    /// What is behind the surface. Default: [`Background::White`].
    pub background: Background,
    /// What the surface is painted with. Default: a light clay.
    pub surface: Surface,
    /// Faces around a vertex that bend by more than this are drawn with an edge between them, others
    /// as one smooth surface. In degrees, clamped to 0..=90. Default: 80.
    pub crease: f64,
    /// Samples along each side of a pixel, clamped to 1..=4. Default: 3, nine samples a pixel.
    pub supersampling: u32,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            width: 600,
            height: 600,
            margin: 0.04,
            view: View::default(),
            background: Background::White,
            surface: Surface::Plain([214, 206, 194]),
            crease: 80.0,
            supersampling: 3,
        }
    }
}

/// What is behind the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// Opaque white.
    White,
    /// An opaque sRGB colour.
    Color([u8; 3]),
    /// Nothing: alpha 0, and edges with the alpha of their share of the pixel.
    Transparent,
}

/// What a surface is painted with.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// One sRGB colour.
    Plain([u8; 3]),
    /// One sRGB colour a vertex, blended across faces. Vertices beyond the list are white.
    Colors(Vec<[u8; 3]>),
    /// One number a vertex, through a perceptual colour map (viridis), blended across faces.
    Scalars {
        /// The numbers. Vertices beyond the list, and numbers that are not finite, are grey.
        values: Vec<f64>,
        /// The numbers drawn darkest and lightest. `None`: the least and greatest of `values`.
        range: Option<[f64; 2]>,
        /// Lines of equal value between this many equal steps of the range, one less than steps. None at
        /// the ends of the range, beyond it, and where the value is the same all over a face.
        isolines: u32,
    },
}

/// Draws a mesh as a shaded picture, fitted into it and seen without perspective.
///
/// * Faces are lit on both sides, so neither their orientation nor holes matter.
/// * Faces without area, with an index out of range or a corner that is not finite are left out; a mesh
///   without any other face gives an empty picture.
/// * Cost: linear in faces and pixels. 28 k vertices at 600 x 600: about 0.1 s.
#[must_use]
pub fn render(mesh: &TriMesh, options: &RenderOptions) -> RgbaImage {
    let faces = drawable_faces(mesh);
    let samples = options.supersampling.clamp(1, 4);
    let (width, height) = (options.width.clamp(1, 8192), options.height.clamp(1, 8192));
    let margin = options.margin.clamp(0.0, 0.45);
    let camera = Camera::fit(mesh, &faces, &options.view, [width * samples, height * samples], margin);
    let buffer = DepthBuffer::draw(mesh, &faces, &camera, [width * samples, height * samples]);
    let normals = normals::corner_normals(mesh, &faces, &camera, options.crease.clamp(0.0, 90.0));
    let paint = Paint::new(mesh.n_vertices(), &options.surface, samples);
    shade::shade(&buffer, &normals, &paint, samples, options.background)
}

/// Width over height of what a view sees of a mesh; 1 when that is nothing.
pub fn aspect(mesh: &TriMesh, view: &View) -> f64 {
    let [width, height] = camera::extent(mesh, &drawable_faces(mesh), view);
    let aspect = width / height;
    if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 }
}

/// The faces that have three corners in space, as plain indices.
fn drawable_faces(mesh: &TriMesh) -> Vec<[usize; 3]> {
    let usable = |v: &usize| mesh.positions.get(*v).is_some_and(|p| p.iter().all(|c| c.is_finite()));
    mesh.faces.iter().map(|f| f.map(|v| v.index())).filter(|f| f.iter().all(usable)).collect()
}

/// The least and the greatest of the numbers that are finite.
#[must_use]
pub fn value_range(values: &[f64]) -> Option<[f64; 2]> {
    let finite = || values.iter().copied().filter(|v| v.is_finite());
    let low = finite().reduce(f64::min)?;
    Some([low, finite().fold(low, f64::max)])
}

/// What an isoline leaves of the light of its surface.
const ISOLINE_LIGHT: f32 = 0.35;

/// A [`Surface`] ready to be asked for a colour at a point of a face, in linear light.
enum Paint {
    Plain([f32; 3]),
    Colors(Vec<[f32; 3]>),
    Scalars {
        /// Scaled to 0..=1; NaN where there is none.
        values: Vec<f32>,
        /// Number of steps between isolines, 0 for no lines.
        steps: f32,
        /// Half the width of an isoline, in samples: lines are a pixel wide.
        half_width: f32,
    },
}

impl Paint {
    fn new(n_vertices: usize, surface: &Surface, samples: u32) -> Self {
        match surface {
            Surface::Plain(color) => Self::Plain(color.map(to_linear)),
            Surface::Colors(colors) => Self::Colors(
                (0..n_vertices).map(|v| colors.get(v).unwrap_or(&[255; 3]).map(to_linear)).collect(),
            ),
            Surface::Scalars { values, range, isolines } => {
                let [low, high] = range.or_else(|| value_range(values)).unwrap_or([0.0; 2]);
                let span = if high > low { high - low } else { 1.0 };
                let scaled = |v: usize| values.get(v).map_or(f64::NAN, |value| (value - low) / span);
                let scaled = |v| if scaled(v).is_finite() { scaled(v) as f32 } else { f32::NAN };
                Self::Scalars {
                    values: (0..n_vertices).map(scaled).collect(),
                    steps: *isolines as f32,
                    half_width: samples as f32 / 2.0,
                }
            }
        }
    }

    /// The colour at barycentric coordinates `at` of `face`; `slopes` are the changes of these
    /// coordinates per sample to the right and up.
    fn color(&self, face: [usize; 3], at: Vector3<f32>, slopes: [Vector3<f32>; 2]) -> Vector3<f32> {
        match self {
            Self::Plain(color) => Vector3::from(*color),
            Self::Colors(colors) => (0..3).map(|i| Vector3::from(colors[face[i]]) * at[i]).sum(),
            Self::Scalars { values, steps, half_width } => {
                let corners = Vector3::from(face.map(|v| values[v]));
                let value = corners.dot(&at);
                let color = Vector3::from(perceptual(f64::from(value)).map(to_linear));
                let level = value * steps;
                let line = level.round();
                let slope = corners.dot(&slopes[0]).hypot(corners.dot(&slopes[1])) * steps;
                let is_line = line > 0.5 && line < steps - 0.5 && (level - line).abs() < half_width * slope;
                if is_line { color * ISOLINE_LIGHT } else { color }
            }
        }
    }
}

#[cfg(test)]
mod tests;
