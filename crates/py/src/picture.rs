//! Shaded pictures, and surfaces to turn.

use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;
use report::render::{Background, Coloring, Label, RenderOptions, Title, View, annotated, collage};
use report::viewer::{self, Geometry};
use report::{ReportError, RgbaImage};

use crate::arrays::mesh_of;
use crate::error::Exception;
use crate::run::run;
use crate::settings::chosen;

/// How a picture is drawn.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Look {
    width: u32,
    height: u32,
    /// How far the viewer walks around the surface, and how far up, in degrees; `None` for its principal axes.
    view: Option<[f64; 2]>,
    up: [f64; 3],
    colormap: String,
    range: Option<[f64; 2]>,
    isolines: u32,
    /// The name of the values, beside a bar of their colors; `None` for no bar.
    bar: Option<String>,
    /// Points of the surface, and what they are called.
    labels: Vec<Label>,
    /// `None` for a transparent one.
    background: Option<[u8; 3]>,
}

/// A picture of a mesh as the bytes of a PNG file, colored by values or by colors at its vertices if there are some. `marks` are
/// the colors of its last vertices. Faces at vertices without finite coordinates are left out.
#[pyfunction]
pub(crate) fn draw<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, i64>,
    values: Option<PyReadonlyArray1<'py, f64>>,
    colors: Option<PyReadonlyArray2<'py, u8>>,
    marks: PyReadonlyArray2<'py, u8>,
    look: Look,
) -> PyResult<Bound<'py, PyBytes>> {
    let mesh = mesh_of(&vertices, &faces)?;
    let usual = RenderOptions::default();
    let coloring = match (values, colors) {
        (None, None) => usual.coloring,
        (None, Some(colors)) => Coloring::Colors(colors.as_slice()?.as_chunks().0.to_vec()),
        (Some(values), _) => Coloring::Scalars {
            values: values.as_slice()?.to_vec(),
            range: look.range,
            isolines: look.isolines,
        },
    };
    let options = RenderOptions {
        width: look.width,
        height: look.height,
        background: look.background.map_or(Background::Transparent, Background::Color),
        coloring,
        marks: marks.as_slice()?.as_chunks().0.to_vec(),
        colors: chosen("colormap", &look.colormap)?,
        view: look.view.map_or(View::Principal, |[azimuth, elevation]| View::Upright {
            azimuth,
            elevation,
            up: look.up.into(),
        }),
        ..usual
    };
    let (bar, labels) = (look.bar.as_deref(), &look.labels);
    png(py, run(py, |observer| Ok(annotated(&mesh, &options, bar, labels, observer)))?)
}

/// Pictures at places in pixels of one picture, and titles by their middles and greatest widths.
#[pyfunction]
pub(crate) fn figure<'py>(
    py: Python<'py>,
    size: [u32; 2],
    background: Option<[u8; 3]>,
    pictures: Vec<(PyBackedBytes, [i64; 2])>,
    titles: Vec<Title>,
    type_size: f64,
) -> PyResult<Bound<'py, PyBytes>> {
    let background = background.map_or(Background::Transparent, Background::Color);
    let image = |(bytes, place): &(PyBackedBytes, [i64; 2])| Ok((RgbaImage::from_png(bytes)?, *place));
    let pictures = pictures.iter().map(image).collect::<Result<Vec<_>, std::io::Error>>();
    let pictures = pictures
        .map_err(|fault| Exception::OptionError.with(format!("pictures must be PNG files: {fault}")))?;
    png(py, run(py, |_| Ok(collage(size, background, &pictures, (&titles, type_size))))?)
}

fn png(py: Python<'_>, image: Result<RgbaImage, ReportError>) -> PyResult<Bound<'_, PyBytes>> {
    let image = image.map_err(|fault| Exception::CanonformError.with(fault))?;
    Ok(PyBytes::new(py, &image.to_png()?))
}

/// The part of all pages of [`scene_page`] that they share.
#[pyfunction]
pub(crate) fn scene_scripts() -> &'static str {
    viewer::scene_scripts()
}

/// A page that shows a surface, colored by values at its vertices if there are some.
#[pyfunction]
pub(crate) fn scene_page(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    faces: PyReadonlyArray2<'_, i64>,
    values: Option<PyReadonlyArray1<'_, f64>>,
    title: &str,
    values_name: &str,
) -> PyResult<String> {
    let mut geometry = Geometry::new(&mesh_of(&vertices, &faces)?);
    if let Some(values) = values {
        geometry = geometry.with_values(values_name, values.as_slice()?);
    }
    Ok(py.detach(|| viewer::scene_page(&geometry, title)))
}
