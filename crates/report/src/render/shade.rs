//! Lighting of the visible samples and their average per pixel.

use nalgebra::Vector3;

use super::coloring::Paint;
use super::options::Background;
use super::raster::DepthBuffer;
use crate::color::{from_linear, to_linear};
use crate::image::RgbaImage;

/// The light that a surface reflects to the viewer, by its linear color, its normal, and the share of ambient light that
/// reaches the point.
fn reflection() -> impl Fn(Vector3<f32>, Vector3<f32>, f32) -> Vector3<f32> {
    // Directions in camera axes: a key light over the viewer's left shoulder and a weaker one from the right, both distant.
    let to_key = Vector3::new(-0.48, 0.66, 0.58).normalize();
    let to_fill = Vector3::new(0.80, 0.05, 0.60).normalize();
    let halfway = (to_key + Vector3::z()).normalize();
    move |base, normal, open| {
        let facing = normal.z.clamp(0.0, 1.0);
        let height = 0.5 + 0.5 * normal.y;
        let sky = Vector3::new(0.33, 0.35, 0.39);
        let ground = Vector3::new(0.16, 0.145, 0.135);
        let ambient = (ground + (sky - ground) * height) * open;
        // Light wraps around the surface a little, as from a wide studio lamp, so there is no hard terminator.
        let wrapped = |light: &Vector3<f32>| ((normal.dot(light) + 0.10) / 1.10).max(0.0);
        let key = Vector3::new(0.80, 0.775, 0.73) * (wrapped(&to_key) * (0.35 + 0.65 * open));
        let fill = Vector3::new(0.12, 0.135, 0.16) * (wrapped(&to_fill) * open);
        let edge = (1.0 - facing).powi(4);
        let rim = 0.10 * edge * height * open;
        let gloss = 0.09 * normal.dot(&halfway).max(0.0).powi(20) * open;
        base.component_mul(&(ambient + key + fill)) + Vector3::repeat(rim + gloss)
    }
}

/// Ambient occlusion in screen space, from the depth buffer alone.
struct Openness<'a> {
    buffer: &'a DepthBuffer,
    /// Offsets to probe, one list for each position of a sample in its pixel. Together they cover a disc evenly,
    /// so the average over a pixel has no noise.
    offsets: Vec<Vec<[isize; 2]>>,
    /// Radius of the disc, in samples.
    radius: f32,
    samples: usize,
}

impl<'a> Openness<'a> {
    const PROBES: usize = 8;

    fn new(buffer: &'a DepthBuffer, samples: usize) -> Self {
        let radius = (0.07 * buffer.size[0].min(buffer.size[1]) as f32).max(2.0);
        let places = samples * samples;
        let total = places * Self::PROBES;
        // A spiral of equal areas by the golden angle.
        let golden = std::f32::consts::PI * (3.0 - 5.0_f32.sqrt());
        let spiral = |i: usize| {
            let (r, angle) = (radius * ((i as f32 + 0.5) / total as f32).sqrt(), golden * i as f32);
            [(r * angle.cos()).round() as isize, (r * angle.sin()).round() as isize]
        };
        let offsets = (0..places)
            .map(|place| (0..Self::PROBES).map(|k| spiral(k * places + place)).collect())
            .collect();
        Self { buffer, offsets, radius, samples }
    }

    /// 1 for a point in the open, towards 0 in a deep fold.
    fn at(&self, column: usize, row: usize, normal: Vector3<f32>) -> f32 {
        let [width, height] = self.buffer.size;
        let here = self.buffer.depth[row * width + column];
        let place = column % self.samples + self.samples * (row % self.samples);
        let mut hidden = 0.0;
        for [dx, dy] in &self.offsets[place] {
            let (x, y) = (column as isize + dx, row as isize + dy);
            if x < 0 || y < 0 || x >= width as isize || y >= height as isize {
                continue;
            }
            let depth = self.buffer.depth[y as usize * width + x as usize];
            if depth == f32::NEG_INFINITY {
                continue;
            }
            let towards = Vector3::new(*dx as f32, -*dy as f32, depth - here);
            let distance = towards.norm().max(1.0);
            // Ten degrees of slack keep a flat surface from occluding itself by rounding. Distant blockers count
            // less, or a leg would darken the body far behind it.
            let blocked = (normal.dot(&towards) / distance - 0.17).max(0.0);
            hidden += blocked / (1.0 + (distance / self.radius).powi(2));
        }
        (1.0 - 1.9 * hidden / Self::PROBES as f32).clamp(0.15, 1.0)
    }
}

/// Lights every visible sample and averages `samples` x `samples` of them per pixel.
pub(super) fn shade(
    buffer: &DepthBuffer,
    normals: &[[Vector3<f32>; 3]],
    paint: &Paint,
    samples: u32,
    background: Background,
) -> RgbaImage {
    let reflected = reflection();
    let samples = samples as usize;
    let openness = Openness::new(buffer, samples);
    let light_at = |column: usize, row: usize| {
        let index = buffer.face[row * buffer.size[0] + column];
        let face = buffer.projected.get(index as usize)?.as_ref()?;
        let at = face.at(column, row).cast::<f32>();
        let corners = &normals[index as usize];
        let normal = (corners[0] * at.x + corners[1] * at.y + corners[2] * at.z).normalize();
        let base = paint.color(face.vertices, at, face.slopes.map(|s| s.cast::<f32>()));
        Some(reflected(base, normal, openness.at(column, row, normal)))
    };
    let [width, height] = buffer.size.map(|s| s / samples);
    let total = (samples * samples) as f32;
    RgbaImage::from_fn(width as u32, height as u32, |column, row| {
        let (left, top) = (column * samples, row * samples);
        let (mut sum, mut covered) = (Vector3::zeros(), 0.0);
        for row in top..top + samples {
            for column in left..left + samples {
                if let Some(light) = light_at(column, row) {
                    sum += light;
                    covered += 1.0;
                }
            }
        }
        let (light, alpha) = match background {
            Background::Color(color) => {
                ((sum + Vector3::from(color.map(to_linear)) * (total - covered)) / total, 1.0)
            }
            Background::Transparent if covered > 0.0 => (sum / covered, covered / total),
            Background::Transparent => (Vector3::zeros(), 0.0),
        };
        [from_linear(light.x), from_linear(light.y), from_linear(light.z), (alpha * 255.0_f32).round() as u8]
    })
}
