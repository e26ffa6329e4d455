//! Maps between surfaces.

use canonform::descriptors::Side;
use canonform::maps::{CorrespondOptions, KnownMap, Mapping, PointMap, SurfaceMap, correspond, score_map};
use canonform::surface::VertexId;
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use report::color::{perceptual, place_colors};

use crate::arrays::{Rows, Vector, matrix_of, of_matrix};
use crate::operators::{Eigenpairs, eigenpairs};
use crate::points::{pairs_of, vertex};
use crate::record::json;
use crate::run::run;
use crate::settings::Settings;
use crate::surface::Surface;

/// The partner of each vertex, its confidence, and the map of functions; of a part, the partners of the vertices of both surfaces.
type MapArrays = (Vector<i64>, Vector<f64>, Rows<f64>, Option<[Vector<i64>; 2]>);
type Maps = (String, Vec<[Option<MapArrays>; 2]>, Rows<u8>);

/// Pairs of vertices, as rows.
type Pairs<'py> = PyReadonlyArray2<'py, i64>;

/// Functions at the vertices of both surfaces, as columns.
type Functions<'py> = (PyReadonlyArray2<'py, f64>, PyReadonlyArray2<'py, f64>);

/// Faces, their corners and the weights of these.
type Points = (Vector<i64>, Rows<i64>, Rows<f64>);

/// Numbers of vertices; -1 stands for none.
fn partners_of(numbers: &PyReadonlyArray1<'_, i64>) -> PyResult<Vec<Option<VertexId>>> {
    let partner = |number: &i64| if *number == -1 { Ok(None) } else { vertex(*number).map(Some) };
    numbers.as_slice()?.iter().map(partner).collect()
}

fn arrays_of(map: &SurfaceMap) -> MapArrays {
    let number = |v: &Option<VertexId>| v.map_or(-1, |v| i64::from(v.0));
    let numbers = |partners: &[Option<VertexId>]| Vector(partners.iter().map(number).collect());
    let partners = map.part.as_ref().map(|part| part.partners.each_ref().map(|of| numbers(of)));
    let confidence = Vector(map.vertex_confidence.clone());
    (numbers(&map.vertices), confidence, of_matrix(&map.functional), partners)
}

/// The maps as the JSON of `canonform match`; the arrays of each of them and of its alternative; and a color for each vertex of
/// the first input, by its place in the form.
#[pyfunction]
pub(crate) fn match_surfaces(
    py: Python<'_>,
    a: &Surface,
    b: &Surface,
    landmarks: Pairs<'_>,
    initial: Option<PyReadonlyArray1<'_, i64>>,
    functions: Option<Functions<'_>>,
    refine: bool,
    settings: Settings,
) -> PyResult<Maps> {
    let [of_a, of_b] =
        [settings.correspond(a.inner.input.repair)?, settings.correspond(b.inner.input.repair)?];
    let initial = initial.as_ref().map(partners_of).transpose()?.unwrap_or_default();
    let functions = functions.map(|(f, g)| [matrix_of(&f), matrix_of(&g)]);
    let known = KnownMap { landmarks: pairs_of(&landmarks)?, initial, functions };
    let (found, colors) = run(py, |observer| {
        let sides = [a.matched(&of_a, observer)?, b.matched(&of_b, observer)?];
        let options = CorrespondOptions { known, ..of_a };
        let search = if refine { correspond } else { score_map };
        let found = search(&sides[0], &sides[1], &options, observer)?;
        let colors = place_colors(sides[0].shape.form_points());
        Ok((found, a.inner.in_input_order(&colors, perceptual(f64::NAN))))
    })?;
    let maps = found.maps.iter().map(|map| [Some(arrays_of(map)), map.alternative.as_deref().map(arrays_of)]);
    Ok((json(&found), maps.collect(), colors.into()))
}

/// The points inside the faces of the other surface that a map takes the vertices of one side to, or its faces, or the corners of
/// its faces, for values at the `corners` of the other: faces, corners and weights; -1 and NaN for what the repair dropped, or a part lacks. `partners` are those of a part and a whole.
#[pyfunction]
pub(crate) fn map_points(
    py: Python<'_>,
    a: &Surface,
    b: &Surface,
    functional: PyReadonlyArray2<'_, f64>,
    landmarks: Pairs<'_>,
    partners: Option<[PyReadonlyArray1<'_, i64>; 2]>,
    of_second: bool,
    of_faces: bool,
    corners: Option<PyReadonlyArray2<'_, f64>>,
    settings: Settings,
) -> PyResult<Points> {
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
    let faces = points.iter().map(|p| p.map_or(-1, |p| i64::from(p.face.0))).collect();
    let corners = points.iter().map(|p| p.map_or([-1; 3], |p| p.corners.map(|v| i64::from(v.0))));
    let weights = points.iter().map(|p| p.map_or([f64::NAN; 3], |p| p.weights));
    Ok((Vector(faces), corners.collect::<Vec<_>>().into(), weights.collect::<Vec<_>>().into()))
}

/// The eigenvalues and eigenfunctions in which maps of a surface are written, and the share of the area around each vertex: of
/// the surface scaled to unit area.
#[pyfunction]
pub(crate) fn map_basis(py: Python<'_>, surface: &Surface, settings: Settings) -> PyResult<Eigenpairs> {
    let options = settings.correspond(surface.inner.input.repair)?;
    let spectrum = run(py, |observer| Ok(surface.matched(&options, observer)?.shape.spectrum().clone()))?;
    Ok(eigenpairs(surface, &spectrum, 1.0))
}
