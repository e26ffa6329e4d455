//! NumPy arrays, to and from the types of the library.

use canonform::linalg::Matrix;
use canonform::mesh::TriMesh;
use canonform::surface::VertexId;
use nalgebra::Point3;
use numpy::{IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::error::Exception;

/// A mesh from an n x 3 array of positions and an m x 3 array of vertex numbers.
pub(crate) fn mesh_of(
    vertices: &PyReadonlyArray2<'_, f64>,
    faces: &PyReadonlyArray2<'_, i64>,
) -> PyResult<TriMesh> {
    let positions = rows(vertices.as_slice()?).map(|p| Point3::from(*p)).collect();
    let vertex = |v: i64| u32::try_from(v).map(VertexId);
    let mut checked = Vec::with_capacity(faces.as_slice()?.len() / 3);
    for (i, [a, b, c]) in rows(faces.as_slice()?).enumerate() {
        let (Ok(a), Ok(b), Ok(c)) = (vertex(*a), vertex(*b), vertex(*c)) else {
            let message = format!("face {i} is ({a}, {b}, {c}); vertices are numbered from 0 to 4294967294");
            return Err(Exception::MeshError.with(&message));
        };
        checked.push([a, b, c]);
    }
    Ok(TriMesh { positions, faces: checked })
}

fn rows<T>(values: &[T]) -> impl Iterator<Item = &[T; 3]> {
    values.as_chunks().0.iter()
}

/// The positions of a mesh, n x 3.
pub(crate) fn positions<'py>(py: Python<'py>, points: &[Point3<f64>]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat = points.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
    matrix(py, flat, [points.len(), 3])
}

/// The faces of a mesh, m x 3.
pub(crate) fn faces<'py>(py: Python<'py>, faces: &[[VertexId; 3]]) -> PyResult<Bound<'py, PyArray2<i64>>> {
    let flat: Vec<i64> = faces.iter().flatten().map(|v| i64::from(v.0)).collect();
    flat.into_pyarray(py).reshape([faces.len(), 3])
}

/// A matrix from its rows, one after the other, without a copy.
pub(crate) fn matrix(
    py: Python<'_>,
    rows: Vec<f64>,
    shape: [usize; 2],
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    rows.into_pyarray(py).reshape(shape)
}

/// A vector, without a copy.
pub(crate) fn vector(py: Python<'_>, values: Vec<f64>) -> Bound<'_, PyArray1<f64>> {
    values.into_pyarray(py)
}

/// A matrix of the library from an array, whatever its layout.
pub(crate) fn matrix_of(array: &PyReadonlyArray2<'_, f64>) -> Matrix {
    let [rows, columns] = [array.shape()[0], array.shape()[1]];
    let array = array.as_array();
    Matrix::from_fn(rows, columns, |i, j| array[(i, j)])
}

/// A matrix of the library.
pub(crate) fn of_matrix<'py>(py: Python<'py>, values: &Matrix) -> PyResult<Bound<'py, PyArray2<f64>>> {
    matrix(py, picked_rows(values, (0..values.nrows()).map(Some)), [values.nrows(), values.ncols()])
}

/// Rows of a matrix, one after the other; NaN where `row` names none.
pub(crate) fn picked_rows(columns: &Matrix, rows: impl Iterator<Item = Option<usize>>) -> Vec<f64> {
    let (n, k) = (columns.nrows(), columns.ncols());
    let values = columns.as_slice();
    let value = |row: Option<usize>, column: usize| row.map_or(f64::NAN, |row| values[column * n + row]);
    rows.flat_map(|row| (0..k).map(move |column| value(row, column))).collect()
}
