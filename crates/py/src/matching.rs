//! Maps between two surfaces.

use canonform::{VertexMap, correspond};
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use report::color::{perceptual, place_colors};

use crate::arrays;
use crate::record::json;
use crate::run::run;
use crate::settings::Settings;
use crate::surface::Surface;

type MapArrays<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f64>>);
type Maps<'py> = (String, Vec<[Option<MapArrays<'py>>; 2]>, Bound<'py, PyArray2<u8>>);

/// The maps as the JSON of `canonform match`; the partner of each vertex and the map of functions under each of them and its
/// alternative; and a colour for each vertex of the second input, by its place in the form.
#[pyfunction]
pub(crate) fn match_surfaces<'py>(
    py: Python<'py>,
    a: &Surface,
    b: &Surface,
    settings: &str,
    progress: Option<Py<PyAny>>,
) -> PyResult<Maps<'py>> {
    let settings = Settings::parse(settings)?;
    let [of_a, of_b] = [settings.correspond(a.inner.repair)?, settings.correspond(b.inner.repair)?];
    let (found, colors) = run(py, &settings.budget()?, progress.as_ref(), |observer| {
        let sides = [a.matched(&of_a, observer)?, b.matched(&of_b, observer)?];
        let found = correspond(&sides[0], &sides[1], &of_a, observer)?;
        let colors = place_colors(sides[1].shape.form_points());
        Ok((found, b.inner.in_input_order(&colors, perceptual(f64::NAN))))
    })?;
    let arrays = |map: &VertexMap| -> PyResult<MapArrays<'py>> {
        let number = |v: &Option<canonform::surface::VertexId>| v.map_or(-1, |v| i64::from(v.0));
        let vertices = map.vertices.iter().map(number).collect::<Vec<_>>().into_pyarray(py);
        let k = map.functional.ncols();
        let rows = arrays::picked_rows(&map.functional, (0..k).map(Some));
        Ok((vertices, arrays::matrix(py, rows, [k, k])?))
    };
    let maps = found
        .maps
        .iter()
        .map(|map| Ok([Some(arrays(map)?), map.alternative.as_deref().map(arrays).transpose()?]));
    let maps = maps.collect::<PyResult<Vec<_>>>()?;
    let n_colors = colors.len();
    let colors = colors.into_flattened().into_pyarray(py).reshape([n_colors, 3])?;
    Ok((json(&found), maps, colors))
}
