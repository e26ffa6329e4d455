//! A color bar with ticks next to an image.

use base::Observer;
use mesh::TriMesh;

use super::coloring::{Coloring, ISOLINE_LIGHT};
use super::draw::render;
use super::options::RenderOptions;
use super::text::{Label, empty, paint, type_size, width_of, write_labels};
use crate::color::{ColorMap, from_linear, to_linear, value_range};
use crate::error::ReportError;
use crate::figure::{PlotAxis, bar_labels};
use crate::image::RgbaImage;

/// Draws like [`render`], with labels at points, and with a color bar of this name and its ticks to the right of the mesh, in
/// an image of the same size.
///
/// There is no bar if the surface has no finite numbers, or if the bar would take more than half of the image.
///
/// # Errors
/// [`ReportError::Exceeded`], and [`ReportError::Draw`] if text cannot be written.
pub fn annotated(
    mesh: &TriMesh,
    options: &RenderOptions,
    bar: Option<&str>,
    labels: &[Label],
    observer: &dyn Observer,
) -> Result<RgbaImage, ReportError> {
    let bar = bar.and_then(|name| ColorBar::new(options, name));
    let taken = bar.as_ref().map_or(0, |bar| bar.width);
    let room = RenderOptions { width: options.size()[0] - taken, ..options.clone() };
    let mut image = render(mesh, &room, observer)?;
    write_labels(&mut image, mesh, &room, labels, &observer.budget())?;
    let Some(bar) = bar else { return Ok(image) };
    let mut image = image.beside(&RgbaImage::new(bar.width, bar.size[1], empty(options.background)));
    bar.paint(&mut image);
    paint(&mut image, options.background, (0.0, 1), "a color bar", |area| {
        let [left, top, height] = [bar.left(), bar.top, bar.height].map(|at| at as i32);
        let width = bar.size[0] as i32 - left - (0.4 * bar.em) as i32;
        let place = area.clone().shrink((left, top), (width, height));
        bar_labels(&place, &bar.axis, bar.em, bar.em, 1)
    })?;
    Ok(image)
}

/// The bar and its labels, in pixels.
struct ColorBar {
    /// Size of the whole image.
    size: [u32; 2],
    /// Pixels taken from the mesh.
    width: u32,
    /// Type size, and width of the bar.
    em: f64,
    top: usize,
    height: usize,
    /// Steps between isolines, 0 for none.
    steps: u32,
    /// The values, their ticks and the name.
    axis: PlotAxis,
    colors: ColorMap,
}

impl ColorBar {
    fn new(options: &RenderOptions, name: &str) -> Option<Self> {
        let Coloring::Scalars { values, range, isolines } = &options.coloring else { return None };
        let [low, high] = range.or_else(|| value_range(values))?;
        // The range of the surface's colors if there is only one value.
        let high = if high > low { high } else { low + 1.0 };
        let size = options.size();
        let high_side = f64::from(size[1]);
        let em = type_size(size);
        if !(high - low).is_finite() || em * 8.0 > high_side {
            return None;
        }
        let height = (high_side * 0.72).round();
        let most = (height / (2.5 * em)).clamp(2.0, 8.0) as usize;
        let axis = PlotAxis::bar(name, "", [low, high], most);
        let numbers = axis.ticks.iter().map(|(_, text)| width_of(text, em)).fold(0.0, f64::max);
        // The bar, ticks, numbers and name.
        let width = (em * (1.0 + 0.8 + 2.4) + numbers.ceil()) as u32;
        let top = ((high_side - height) / 2.0).round() as usize;
        let (steps, colors, height) = (*isolines, options.colors, height as usize);
        (width <= size[0] / 2).then_some(Self { size, width, em, top, height, steps, axis, colors })
    }

    fn left(&self) -> usize {
        (self.size[0] - self.width) as usize + (0.3 * self.em) as usize
    }

    /// Fills the bar with the color map and its isolines.
    fn paint(&self, image: &mut RgbaImage) {
        let (left, right) = (self.left(), self.left() + self.em as usize);
        let half_line = self.em / 24.0;
        let rows =
            image.pixels_mut().chunks_exact_mut(self.size[0] as usize).skip(self.top).take(self.height);
        for (i, row) in rows.enumerate() {
            let share = 1.0 - (i as f64 + 0.5) / self.height as f64;
            let level = share * f64::from(self.steps);
            let line = level.round();
            let pixels_away = (level - line).abs() * self.height as f64 / f64::from(self.steps.max(1));
            let is_inside = line > 0.5 && line < f64::from(self.steps) - 0.5;
            let light = if is_inside && pixels_away <= half_line.max(0.5) { ISOLINE_LIGHT } else { 1.0 };
            let [r, g, b] = self.colors.color(share).map(|c| from_linear(to_linear(c) * light));
            row[left..right].fill([r, g, b, 255]);
        }
    }
}
