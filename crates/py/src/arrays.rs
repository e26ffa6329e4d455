//! NumPy arrays, to and from the types of the library.

use canonform::linalg::Matrix;
use canonform::mesh::TriMesh;
use canonform::surface::VertexId;
use nalgebra::Point3;
use numpy::{
    Element, IntoPyArray, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods,
};
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
            return Err(Exception::MeshError.with(message));
        };
        checked.push([a, b, c]);
    }
    Ok(TriMesh { positions, faces: checked })
}

fn rows<T>(values: &[T]) -> impl Iterator<Item = &[T; 3]> {
    values.as_chunks().0.iter()
}

/// A vector, which Python gets without a copy.
pub(crate) struct Vector<T>(pub(crate) Vec<T>);

impl<'py, T: Element> IntoPyObject<'py> for Vector<T> {
    type Target = PyArray1<T>;
    type Output = Bound<'py, PyArray1<T>>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        Ok(self.0.into_pyarray(py))
    }
}

/// The rows of a matrix, one after the other, and its shape. Python gets it without a copy.
pub(crate) struct Rows<T>(pub(crate) Vec<T>, pub(crate) [usize; 2]);

impl<'py, T: Element> IntoPyObject<'py> for Rows<T> {
    type Target = PyArray2<T>;
    type Output = Bound<'py, PyArray2<T>>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        self.0.into_pyarray(py).reshape(self.1)
    }
}

impl<T, const N: usize> From<Vec<[T; N]>> for Rows<T> {
    fn from(rows: Vec<[T; N]>) -> Self {
        let n = rows.len();
        Self(rows.into_flattened(), [n, N])
    }
}

/// The positions of a mesh, n x 3.
pub(crate) fn positions(points: &[Point3<f64>]) -> Rows<f64> {
    points.iter().map(|p| [p.x, p.y, p.z]).collect::<Vec<_>>().into()
}

/// The faces of a mesh, m x 3.
pub(crate) fn faces(faces: &[[VertexId; 3]]) -> Rows<i64> {
    faces.iter().map(|face| face.map(|v| i64::from(v.0))).collect::<Vec<_>>().into()
}

/// A matrix of the library from an array, whatever its layout.
pub(crate) fn matrix_of(array: &PyReadonlyArray2<'_, f64>) -> Matrix {
    let [rows, columns] = [array.shape()[0], array.shape()[1]];
    let array = array.as_array();
    Matrix::from_fn(rows, columns, |i, j| array[(i, j)])
}

/// A matrix of the library.
pub(crate) fn of_matrix(values: &Matrix) -> Rows<f64> {
    picked_rows(values, (0..values.nrows()).map(Some))
}

/// Rows of a matrix; NaN where `row` names none.
pub(crate) fn picked_rows(columns: &Matrix, rows: impl ExactSizeIterator<Item = Option<usize>>) -> Rows<f64> {
    let (n, shape) = (columns.nrows(), [rows.len(), columns.ncols()]);
    let values = columns.as_slice();
    let value = |row: Option<usize>, column: usize| row.map_or(f64::NAN, |row| values[column * n + row]);
    Rows(rows.flat_map(|row| (0..shape[1]).map(move |column| value(row, column))).collect(), shape)
}
