//! From a mesh to an image.

use base::{Exceeded, Observer};
use mesh::TriMesh;

use super::camera::{Camera, drawable};
use super::coloring::Paint;
use super::normals::corner_normals;
use super::options::RenderOptions;
use super::raster::DepthBuffer;
use super::shade::shade;
use crate::image::RgbaImage;

/// Draws a mesh as a shaded orthographic image in which it fits.
///
/// * Faces are lit on both sides, so neither their orientation nor holes matter.
/// * Faces that are degenerate, or have a corner that does not exist or is not finite, are left out. Without any
///   other face the image is empty.
/// * Cost: linear in faces and pixels where few faces hide each other. 28 k vertices at 600 x 600 take about 0.1 s.
///
/// # Errors
/// [`Exceeded`] if the budget of the observer does not suffice.
pub fn render(
    mesh: &TriMesh,
    options: &RenderOptions,
    observer: &dyn Observer,
) -> Result<RgbaImage, Exceeded> {
    let budget = observer.budget();
    budget.check()?;
    let mesh = &drawable(mesh);
    let samples = options.supersampling.clamp(1, 4);
    let size = options.size().map(|side| side * samples);
    let camera = Camera::fit(mesh, &options.view, size);
    let buffer = DepthBuffer::draw(mesh, &camera, size, &budget)?;
    let normals = corner_normals(mesh, &camera, options.crease.clamp(0.0, 90.0));
    let paint = Paint::new(mesh.n_vertices(), (&options.coloring, options.colors), &options.marks, samples);
    budget.check()?;
    Ok(shade(&buffer, &normals, &paint, samples, options.background))
}
