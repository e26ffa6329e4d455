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

#[cfg(test)]
mod tests {
    use super::super::options::Background;
    use super::*;
    use crate::tests::meshes::sphere;

    fn options(values: Vec<f64>) -> RenderOptions {
        let coloring = Coloring::Scalars { values, range: None, isolines: 4 };
        RenderOptions { width: 320, height: 240, coloring, ..RenderOptions::default() }
    }

    fn with_bar(options: &RenderOptions) -> RgbaImage {
        annotated(&sphere(12), options, Some("z"), &[], &()).unwrap()
    }

    fn heights() -> Vec<f64> {
        sphere(12).positions.iter().map(|p| p.z).collect()
    }

    #[test]
    fn the_bar_shares_the_image_with_the_mesh() {
        let options = options(heights());
        let (plain, image) = (render(&sphere(12), &options, &()).unwrap(), with_bar(&options));
        assert_eq!((image.width(), image.height()), (320, 240));
        assert!(plain != image);
        let other = RenderOptions { colors: ColorMap::Magma, ..options.clone() };
        assert!(with_bar(&other) != image);
        let bar = ColorBar::new(&options, "z").unwrap();
        let column = bar.left() as u32 + bar.em as u32 / 2;
        let [low, high] = [bar.top + bar.height - 1, bar.top].map(|row| row as u32);
        for (row, end) in [(low, ColorMap::Viridis.color(0.0)), (high, ColorMap::Viridis.color(1.0))] {
            let found = image.pixel(column, row);
            assert!(found.iter().zip(end).all(|(a, b)| a.abs_diff(b) < 8), "{found:?} {end:?}");
        }
        let lines = (high..=low).filter(|&y| image.pixel(column, y).iter().all(|c| *c > 150)).count();
        assert_eq!(lines, 0, "the bar has no holes");
        assert_eq!(image, with_bar(&options));
    }

    #[test]
    fn surfaces_without_finite_numbers_and_small_images_have_no_bar() {
        let has_bar = |options: &RenderOptions| ColorBar::new(options, "").is_some();
        assert!(has_bar(&options(heights())));
        assert!(!has_bar(&options(vec![f64::NAN])) && !has_bar(&options(vec![])));
        assert!(!has_bar(&options(vec![-1e308, 1e308])));
        assert!(!has_bar(&RenderOptions { width: 90, ..options(heights()) }));
        assert!(!has_bar(&RenderOptions { height: 60, ..options(heights()) }));
        assert!(!has_bar(&RenderOptions::default()));
    }

    #[test]
    fn labels_contrast_with_every_background() {
        let on = |background| {
            let options = RenderOptions { background, ..options(heights()) };
            let image = with_bar(&options);
            let right = image.pixels().iter().enumerate().filter(|(i, _)| i % 320 > 270);
            right.map(|(_, pixel)| *pixel).collect::<Vec<_>>()
        };
        assert!(on(Background::WHITE).iter().any(|p| p[0] < 60));
        assert!(on(Background::Color([20, 20, 24])).iter().any(|p| p[0] > 200));
        let clear = on(Background::Transparent);
        assert!(
            clear.iter().any(|p| p[3] == 0) && clear.iter().any(|p| p[0].abs_diff(118) < 3 && p[3] > 200)
        );
    }
}
