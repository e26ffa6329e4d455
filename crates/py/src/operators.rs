//! What surfaces are computed with: Laplacians, their eigenfunctions, and nearest points. Rows are vertices of the input.

use canonform::descriptors::LaplaceSpectrum;
use canonform::surface::VertexId;
use canonform::surface::laplacian::Laplacian;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays;
use crate::error::Exception;
use crate::points::point_of;
use crate::run::run;
use crate::surface::Surface;

/// Rows, columns and values of a matrix, and the areas around the vertices.
type Operators<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
);

/// Eigenvalues, eigenfunctions as columns, and the areas around the vertices.
pub(crate) type Eigenpairs<'py> =
    (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// Points, their distances, and the faces that they lie in.
type Nearest<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<i64>>);

/// The stiffness matrix, in which entries of the same place add up, and the area around each vertex in squared mesh units.
/// Vertices that the repair dropped have neither; of those that it merged, the first stands for all.
#[pyfunction]
pub(crate) fn laplacian<'py>(py: Python<'py>, surface: &Surface) -> PyResult<Operators<'py>> {
    let inner = &surface.inner;
    let (entries, masses) = run(py, |_| {
        let laplacian = Laplacian::new(inner.intrinsic());
        let sq_unit = laplacian.metric.unit.powi(2);
        let masses: Vec<f64> = laplacian.masses().iter().map(|mass| mass * sq_unit).collect();
        Ok((laplacian.stiffness_entries().collect::<Vec<_>>(), masses))
    })?;
    let input = |v: usize| inner.input_vertex(VertexId::from(v)).index();
    let mut of_input = vec![0.0; inner.n_input_vertices()];
    masses.iter().enumerate().for_each(|(v, mass)| of_input[input(v)] = *mass);
    let (mut rows, mut columns, mut values) = (Vec::new(), Vec::new(), Vec::new());
    for (i, j, value) in entries {
        let [i, j] = [i, j].map(|v| input(v) as i64);
        let mirrored = if i == j { None } else { Some((j, i)) };
        for (row, column) in [(i, j)].into_iter().chain(mirrored) {
            rows.push(row);
            columns.push(column);
            values.push(value);
        }
    }
    Ok((rows.into_pyarray(py), columns.into_pyarray(py), values.into_pyarray(py), of_input.into_pyarray(py)))
}

/// The smallest eigenvalues of the Laplacian, in one over squared mesh units, and its eigenfunctions as columns, orthonormal
/// with the areas around vertices; NaN for vertices that the repair dropped.
#[pyfunction]
pub(crate) fn eigenbasis<'py>(py: Python<'py>, surface: &Surface, k: usize) -> PyResult<Eigenpairs<'py>> {
    let spectrum = run(py, |observer| Ok(LaplaceSpectrum::new(surface.inner.intrinsic(), k, observer)?))?;
    let area = spectrum.area;
    eigenpairs(py, surface, &spectrum, area)
}

/// Eigenpairs of a surface of this area that has the shape of the surface, in the order of the input.
pub(crate) fn eigenpairs<'py>(
    py: Python<'py>,
    surface: &Surface,
    spectrum: &LaplaceSpectrum,
    area: f64,
) -> PyResult<Eigenpairs<'py>> {
    let inner = &surface.inner;
    let values = spectrum.values.iter().map(|value| value / area).collect();
    let map = inner.input.remap.all_to_new();
    let mut masses = vec![0.0; map.len()];
    for (v, share) in spectrum.masses.iter().enumerate() {
        masses[inner.input_vertex(VertexId::from(v)).index()] = share * area;
    }
    let shape = [map.len(), spectrum.vectors.ncols()];
    let mut rows = arrays::picked_rows(&spectrum.vectors, map.map(|vertex| vertex.map(VertexId::index)));
    rows.iter_mut().for_each(|value| *value /= area.sqrt());
    Ok((arrays::vector(py, values), arrays::matrix(py, rows, shape)?, arrays::vector(py, masses)))
}

/// For each of several points in space, the nearest point of the faces of the input that the repair kept.
#[pyfunction]
pub(crate) fn closest_points<'py>(
    py: Python<'py>,
    surface: &Surface,
    points: PyReadonlyArray2<'py, f64>,
) -> PyResult<Nearest<'py>> {
    let queries = points.as_slice()?.as_chunks::<3>().0;
    let found = run(py, |_| {
        let (tree, numbers) = surface.tree();
        let nearest = |point: &[f64; 3]| {
            let found = tree.nearest(&(*point).into())?;
            Some((found.point, found.sq_distance.sqrt(), numbers[found.face]))
        };
        Ok(queries.par_iter().map(nearest).collect::<Option<Vec<_>>>())
    })?;
    let found = found.ok_or_else(|| Exception::MeshError.with("the surface has no area"))?;
    let places = found.iter().flat_map(|(point, ..)| [point.x, point.y, point.z]).collect();
    let distances = found.iter().map(|(_, distance, _)| *distance).collect();
    let faces: Vec<i64> = found.iter().map(|(.., face)| *face).collect();
    Ok((arrays::matrix(py, places, [found.len(), 3])?, arrays::vector(py, distances), faces.into_pyarray(py)))
}

/// The logarithmic map about a point, one row for each vertex of the input; NaN for those that the repair dropped.
#[pyfunction]
pub(crate) fn log_map<'py>(
    py: Python<'py>,
    surface: &Surface,
    source: &Bound<'py, PyAny>,
    max_distance: f64,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (inner, source) = (&surface.inner, point_of(source)?);
    let map = run(py, |observer| {
        let source = inner.locate(&source)?;
        Ok(canonform::geodesics::log_map(inner.intrinsic(), source, max_distance, observer)?)
    })?;
    let of_input = inner.input.remap.all_to_new();
    let rows = of_input.flat_map(|vertex| vertex.map_or([f64::NAN; 2], |vertex| map[vertex.index()]));
    arrays::matrix(py, rows.collect(), [inner.n_input_vertices(), 2])
}
