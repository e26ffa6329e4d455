//! Maps between surfaces.

use canonform::descriptors::Side;
use canonform::maps::{CorrespondOptions, KnownMap, Mapping, PointMap, SurfaceMap, correspond, score_map};
use canonform::surface::VertexId;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use report::color::{perceptual, place_colors};

use crate::arrays::{self, matrix_of};
use crate::operators::{Eigenpairs, eigenpairs};
use crate::points::vertex;
use crate::record::json;
use crate::run::run;
use crate::settings::Settings;
use crate::surface::Surface;

/// The partner of each vertex, its confidence, and the map of functions; of a part, the partners of the vertices of both surfaces.
type MapArrays<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray2<f64>>,
    Option<[Bound<'py, PyArray1<i64>>; 2]>,
);
type Maps<'py> = (String, Vec<[Option<MapArrays<'py>>; 2]>, Bound<'py, PyArray2<u8>>);

/// Pairs of vertices, as rows.
type Pairs<'py> = PyReadonlyArray2<'py, i64>;

/// Functions at the vertices of both surfaces, as columns.
type Functions<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>);

/// Faces, their corners and the weights of these.
type Points<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<i64>>, Bound<'py, PyArray2<f64>>);

fn pairs_of(pairs: &Pairs<'_>) -> PyResult<Vec<[VertexId; 2]>> {
    let pairs = pairs.as_slice()?.as_chunks::<2>().0.iter();
    pairs.map(|[a, b]| Ok([vertex(*a)?, vertex(*b)?])).collect()
}

/// Numbers of vertices; -1 stands for none.
fn partners_of(numbers: &PyReadonlyArray1<'_, i64>) -> PyResult<Vec<Option<VertexId>>> {
    let partner = |number: &i64| if *number == -1 { Ok(None) } else { vertex(*number).map(Some) };
    numbers.as_slice()?.iter().map(partner).collect()
}

fn known(
    landmarks: &Pairs<'_>,
    initial: Option<PyReadonlyArray1<'_, i64>>,
    functions: Option<Functions<'_>>,
) -> PyResult<KnownMap> {
    let initial = initial.as_ref().map(partners_of).transpose()?.unwrap_or_default();
    let functions = functions.map(|(f, g)| [matrix_of(&f), matrix_of(&g)]);
    Ok(KnownMap { landmarks: pairs_of(landmarks)?, initial, functions })
}

fn arrays_of<'py>(py: Python<'py>, map: &SurfaceMap) -> PyResult<MapArrays<'py>> {
    let number = |v: &Option<VertexId>| v.map_or(-1, |v| i64::from(v.0));
    let numbers =
        |partners: &[Option<VertexId>]| partners.iter().map(number).collect::<Vec<_>>().into_pyarray(py);
    let partners = map.part.as_ref().map(|part| part.partners.each_ref().map(|of| numbers(of)));
    let confidence = arrays::vector(py, map.vertex_confidence.clone());
    Ok((numbers(&map.vertices), confidence, arrays::of_matrix(py, &map.functional)?, partners))
}

/// The maps as the JSON of `canonform match`; the arrays of each of them and of its alternative; and a color for each vertex of
/// the first input, by its place in the form.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn match_surfaces<'py>(
    py: Python<'py>,
    a: &Surface,
    b: &Surface,
    landmarks: Pairs<'py>,
    initial: Option<PyReadonlyArray1<'py, i64>>,
    functions: Option<Functions<'py>>,
    refine: bool,
    settings: Settings,
) -> PyResult<Maps<'py>> {
    let [of_a, of_b] =
        [settings.correspond(a.inner.input.repair)?, settings.correspond(b.inner.input.repair)?];
    let known = known(&landmarks, initial, functions)?;
    let (found, colors) = run(py, |observer| {
        let sides = [a.matched(&of_a, observer)?, b.matched(&of_b, observer)?];
        let options = CorrespondOptions { known, ..of_a };
        let search = if refine { correspond } else { score_map };
        let found = search(&sides[0], &sides[1], &options, observer)?;
        let colors = place_colors(sides[0].shape.form_points());
        Ok((found, a.inner.in_input_order(&colors, perceptual(f64::NAN))))
    })?;
    let maps = found.maps.iter().map(|map| {
        let other = map.alternative.as_deref().map(|map| arrays_of(py, map)).transpose()?;
        Ok([Some(arrays_of(py, map)?), other])
    });
    let maps = maps.collect::<PyResult<Vec<_>>>()?;
    let n_colors = colors.len();
    let colors = colors.into_flattened().into_pyarray(py).reshape([n_colors, 3])?;
    Ok((json(&found), maps, colors))
}

/// The points inside the faces of the other surface that a map takes the vertices of one side to, or its faces, or the corners of
/// its faces, for values at the `corners` of the other: faces, corners and weights; -1 and NaN for what the repair dropped, or a part lacks. `partners` are those of a part and a whole.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub(crate) fn map_points<'py>(
    py: Python<'py>,
    a: &Surface,
    b: &Surface,
    functional: PyReadonlyArray2<'py, f64>,
    landmarks: Pairs<'py>,
    partners: Option<[PyReadonlyArray1<'py, i64>; 2]>,
    of_second: bool,
    of_faces: bool,
    corners: Option<PyReadonlyArray2<'py, f64>>,
    settings: Settings,
) -> PyResult<Points<'py>> {
    let [of_a, of_b] =
        [settings.correspond(a.inner.input.repair)?, settings.correspond(b.inner.input.repair)?];
    let (functional, landmarks) = (matrix_of(&functional), pairs_of(&landmarks)?);
    let partners = match &partners {
        Some([a, b]) => Some([partners_of(a)?, partners_of(b)?]),
        None => None,
    };
    let corners = corners.as_ref().map(matrix_of);
    let of = if of_second { Side::Second } else { Side::First };
    let PointMap { points } = run(py, |observer| {
        let sides = [a.matched(&of_a, observer)?, b.matched(&of_b, observer)?];
        let mapping = Mapping {
            shapes: [&*sides[0], &*sides[1]],
            functional: &functional,
            landmarks: &landmarks,
            partners: partners.as_ref(),
        };
        Ok(match &corners {
            Some(values) => mapping.corners(of, values).unwrap_or(PointMap { points: Vec::new() }),
            None if of_faces => mapping.faces(of),
            None => mapping.vertices(of),
        })
    })?;
    let faces: Vec<i64> = points.iter().map(|p| p.map_or(-1, |p| i64::from(p.face.0))).collect();
    let corners: Vec<i64> =
        points.iter().flat_map(|p| p.map_or([-1; 3], |p| p.corners.map(|v| i64::from(v.0)))).collect();
    let weights = points.iter().flat_map(|p| p.map_or([f64::NAN; 3], |p| p.weights)).collect();
    let n = points.len();
    Ok((
        faces.into_pyarray(py),
        corners.into_pyarray(py).reshape([n, 3])?,
        arrays::matrix(py, weights, [n, 3])?,
    ))
}

/// The eigenvalues and eigenfunctions in which maps of a surface are written, and the share of the area around each vertex: of
/// the surface scaled to unit area.
#[pyfunction]
pub(crate) fn map_basis<'py>(
    py: Python<'py>,
    surface: &Surface,
    settings: Settings,
) -> PyResult<Eigenpairs<'py>> {
    let options = settings.correspond(surface.inner.input.repair)?;
    let spectrum = run(py, |observer| Ok(surface.matched(&options, observer)?.shape.spectrum().clone()))?;
    eigenpairs(py, surface, &spectrum, 1.0)
}
