//! Colors of a surface, before lighting.

use nalgebra::Vector3;

use crate::color::{ColorMap, to_linear, value_range};

/// Colors of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Coloring {
    /// One sRGB color.
    Plain([u8; 3]),
    /// One number per vertex, mapped to [`colors`](super::RenderOptions::colors) and interpolated across faces.
    Scalars {
        /// The numbers. Vertices beyond the list and numbers that are not finite are gray.
        values: Vec<f64>,
        /// The ends of the color map. `None`: the least and the greatest of `values`.
        range: Option<[f64; 2]>,
        /// The number of equal steps of the range that isolines separate, 0 for no isolines. There is none at the
        /// ends of the range, and none on faces where the value is constant.
        isolines: u32,
    },
    /// One sRGB color per vertex, interpolated across faces in linear light. Vertices beyond the list are gray.
    Colors(Vec<[u8; 3]>),
}

/// The share of light that an isoline leaves of its surface.
pub(super) const ISOLINE_LIGHT: f32 = 0.35;

/// The color of a vertex without one.
const MISSING: [u8; 3] = [160, 160, 160];

/// The colors of a surface and of its marks, in linear light.
pub(super) struct Paint {
    surface: Coat,
    /// The colors of the last vertices, and where they begin.
    marks: Vec<Vector3<f32>>,
    first_mark: usize,
}

/// A [`Coloring`] in linear light.
enum Coat {
    Plain([f32; 3]),
    Scalars {
        /// Scaled to 0..=1; NaN for missing values.
        values: Vec<f32>,
        /// Number of steps between isolines, 0 for no isolines.
        steps: f32,
        /// Half the width of an isoline, in samples: isolines are one pixel wide.
        half_width: f32,
        colors: ColorMap,
    },
    Colors(Vec<Vector3<f32>>),
}

impl Paint {
    pub(super) fn new(
        n_vertices: usize,
        (coloring, colors): (&Coloring, ColorMap),
        marks: &[[u8; 3]],
        samples: u32,
    ) -> Self {
        let marks: Vec<_> = marks.iter().map(|color| Vector3::from(color.map(to_linear))).collect();
        let first_mark = n_vertices.saturating_sub(marks.len());
        Self { surface: Coat::new(n_vertices, coloring, colors, samples), marks, first_mark }
    }

    /// The color at barycentric coordinates `at` of `face`; `slopes` are the changes of these coordinates per
    /// sample to the right and down.
    pub(super) fn color(
        &self,
        face: [usize; 3],
        at: Vector3<f32>,
        slopes: [Vector3<f32>; 2],
    ) -> Vector3<f32> {
        match face.map(|v| v.checked_sub(self.first_mark).and_then(|mark| self.marks.get(mark))) {
            [Some(a), Some(b), Some(c)] => a * at.x + b * at.y + c * at.z,
            _ => self.surface.color(face, at, slopes),
        }
    }
}

impl Coat {
    fn new(n_vertices: usize, coloring: &Coloring, colors: ColorMap, samples: u32) -> Self {
        match coloring {
            Coloring::Plain(color) => Self::Plain(color.map(to_linear)),
            Coloring::Colors(colors) => {
                let color = |v: usize| colors.get(v).copied().unwrap_or(MISSING);
                Self::Colors((0..n_vertices).map(|v| Vector3::from(color(v).map(to_linear))).collect())
            }
            Coloring::Scalars { values, range, isolines } => {
                let [low, high] = range.or_else(|| value_range(values)).unwrap_or([0.0; 2]);
                let span = if high > low { high - low } else { 1.0 };
                let scaled = |v: usize| values.get(v).map_or(f64::NAN, |value| (value - low) / span);
                let scaled = |v| if scaled(v).is_finite() { scaled(v) as f32 } else { f32::NAN };
                Self::Scalars {
                    values: (0..n_vertices).map(scaled).collect(),
                    steps: *isolines as f32,
                    half_width: samples as f32 / 2.0,
                    colors,
                }
            }
        }
    }

    fn color(&self, face: [usize; 3], at: Vector3<f32>, slopes: [Vector3<f32>; 2]) -> Vector3<f32> {
        match self {
            Self::Plain(color) => Vector3::from(*color),
            Self::Colors(colors) => {
                let [a, b, c] = face.map(|v| colors[v]);
                a * at.x + b * at.y + c * at.z
            }
            Self::Scalars { values, steps, half_width, colors } => {
                let corners = Vector3::from(face.map(|v| values[v]));
                let value = corners.dot(&at);
                let color = Vector3::from(colors.color(f64::from(value)).map(to_linear));
                let level = value * steps;
                let line = level.round();
                let slope = corners.dot(&slopes[0]).hypot(corners.dot(&slopes[1])) * steps;
                let is_line = line > 0.5 && line < steps - 0.5 && (level - line).abs() < half_width * slope;
                if is_line { color * ISOLINE_LIGHT } else { color }
            }
        }
    }
}
