//! What surfaces are computed with: Laplacians, their eigenfunctions, and nearest points. Rows are vertices of the input.

use canonform::descriptors::LaplaceSpectrum;
use canonform::surface::VertexId;
use canonform::surface::laplacian::Laplacian;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{Rows, Vector, picked_rows, positions};
use crate::error::Exception;
use crate::points::point_of;
use crate::run::run;
use crate::surface::Surface;

/// Rows, columns and values of a matrix, and the areas around the vertices.
type Operators = (Vector<i64>, Vector<i64>, Vector<f64>, Vector<f64>);

/// Eigenvalues, eigenfunctions as columns, and the areas around the vertices.
pub(crate) type Eigenpairs = (Vector<f64>, Rows<f64>, Vector<f64>);

/// Points, their distances, and the faces that they lie in.
type Nearest = (Rows<f64>, Vector<f64>, Vector<i64>);

/// The stiffness matrix, in which entries of the same place add up, and the area around each vertex in squared mesh units.
/// Vertices that the repair dropped have neither; of those that it merged, the first stands for all.
#[pyfunction]
pub(crate) fn laplacian(py: Python<'_>, surface: &Surface) -> PyResult<Operators> {
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
    Ok((Vector(rows), Vector(columns), Vector(values), Vector(of_input)))
}

/// The smallest eigenvalues of the Laplacian, in one over squared mesh units, and its eigenfunctions as columns, orthonormal
/// with the areas around vertices; NaN for vertices that the repair dropped.
#[pyfunction]
pub(crate) fn eigenbasis(py: Python<'_>, surface: &Surface, k: usize) -> PyResult<Eigenpairs> {
    let spectrum = run(py, |observer| Ok(LaplaceSpectrum::new(surface.inner.intrinsic(), k, observer)?))?;
    Ok(eigenpairs(surface, &spectrum, spectrum.area))
}

/// Eigenpairs of a surface of this area that has the shape of the surface, in the order of the input.
pub(crate) fn eigenpairs(surface: &Surface, spectrum: &LaplaceSpectrum, area: f64) -> Eigenpairs {
    let inner = &surface.inner;
    let values = spectrum.values.iter().map(|value| value / area).collect();
    let map = inner.input.remap.all_to_new();
    let mut masses = vec![0.0; map.len()];
    for (v, share) in spectrum.masses.iter().enumerate() {
        masses[inner.input_vertex(VertexId::from(v)).index()] = share * area;
    }
    let mut rows = picked_rows(&spectrum.vectors, map.map(|vertex| vertex.map(VertexId::index)));
    rows.0.iter_mut().for_each(|value| *value /= area.sqrt());
    (Vector(values), rows, Vector(masses))
}

/// For each of several points in space, the nearest point of the faces of the input that the repair kept.
#[pyfunction]
pub(crate) fn closest_points(
    py: Python<'_>,
    surface: &Surface,
    points: PyReadonlyArray2<'_, f64>,
) -> PyResult<Nearest> {
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
    let places: Vec<_> = found.iter().map(|(point, ..)| *point).collect();
    let (distances, faces) = found.iter().map(|(_, distance, face)| (*distance, *face)).unzip();
    Ok((positions(&places), Vector(distances), Vector(faces)))
}

/// The logarithmic map about a point, one row for each vertex of the input; NaN for those that the repair dropped.
#[pyfunction]
pub(crate) fn log_map(
    py: Python<'_>,
    surface: &Surface,
    source: &Bound<'_, PyAny>,
    max_distance: f64,
) -> PyResult<Rows<f64>> {
    let (inner, source) = (&surface.inner, point_of(source)?);
    let map = run(py, |observer| {
        let source = inner.locate(&source)?;
        Ok(canonform::geodesics::log_map(inner.intrinsic(), source, max_distance, observer)?)
    })?;
    let of_input = inner.input.remap.all_to_new();
    let rows = of_input.map(|vertex| vertex.map_or([f64::NAN; 2], |vertex| map[vertex.index()]));
    Ok(rows.collect::<Vec<_>>().into())
}
