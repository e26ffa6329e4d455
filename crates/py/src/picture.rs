//! Shaded pictures, and surfaces to turn.

use canonform::mesh::TriMesh;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use report::render::{Background, Coloring, RenderOptions, render};
use report::viewer::{self, Geometry};

use crate::arrays;
use crate::run::run;

/// A picture of a mesh as the bytes of a PNG file with a transparent background, coloured by values or by colours at its
/// vertices if there are some. Faces at vertices without finite coordinates are left out.
#[pyfunction]
pub(crate) fn draw<'py>(
    py: Python<'py>,
    vertices: PyReadonlyArray2<'py, f64>,
    faces: PyReadonlyArray2<'py, i64>,
    values: Option<PyReadonlyArray1<'py, f64>>,
    colors: Option<PyReadonlyArray2<'py, u8>>,
    size: [u32; 2],
) -> PyResult<Bound<'py, PyBytes>> {
    let mesh = finite_mesh(&vertices, &faces)?;
    let coloring = match (values, colors) {
        (None, None) => RenderOptions::default().coloring,
        (None, Some(colors)) => Coloring::Colors(colors.as_slice()?.as_chunks().0.to_vec()),
        (Some(values), _) => {
            Coloring::Scalars { values: values.as_slice()?.to_vec(), range: None, isolines: 0 }
        }
    };
    let [width, height] = size;
    let background = Background::Transparent;
    let options = RenderOptions { width, height, background, coloring, ..RenderOptions::default() };
    let image = run(py, |observer| Ok(render(&mesh, &options, observer)?))?;
    Ok(PyBytes::new(py, &image.to_png()?))
}

/// A page that shows a surface, coloured by values at its vertices if there are some.
#[pyfunction]
pub(crate) fn scene_page(
    py: Python<'_>,
    vertices: PyReadonlyArray2<'_, f64>,
    faces: PyReadonlyArray2<'_, i64>,
    values: Option<PyReadonlyArray1<'_, f64>>,
    title: &str,
    values_name: &str,
) -> PyResult<String> {
    let mut geometry = Geometry::new(&finite_mesh(&vertices, &faces)?);
    if let Some(values) = values {
        geometry = geometry.with_values(values_name, values.as_slice()?);
    }
    Ok(py.detach(|| viewer::scene_page(geometry, title)))
}

/// The mesh without the faces at vertices that have no finite coordinates.
fn finite_mesh(vertices: &PyReadonlyArray2<'_, f64>, faces: &PyReadonlyArray2<'_, i64>) -> PyResult<TriMesh> {
    let mut mesh: TriMesh = arrays::mesh_of(vertices, faces)?;
    let finite: Vec<bool> = mesh.positions.iter().map(|p| p.coords.iter().all(|x| x.is_finite())).collect();
    mesh.faces.retain(|face| face.iter().all(|v| finite.get(v.index()).is_some_and(|finite| *finite)));
    for (p, finite) in mesh.positions.iter_mut().zip(finite) {
        if !finite {
            *p = Default::default();
        }
    }
    Ok(mesh)
}
