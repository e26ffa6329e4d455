//! Points of a surface as Python writes them.

use canonform::mesh::{InputPoint, ParsePointError};
use canonform::surface::VertexId;
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyBool;

use crate::error::Exception;

/// Points of the input: vertex numbers, or text such as `17-42@0.3`.
pub(crate) fn points_of(points: &Bound<'_, PyAny>) -> PyResult<Vec<InputPoint>> {
    let given = points.try_iter().map_err(|_| not_a_point(points))?;
    given.map(|point| point_of(&point?)).collect()
}

pub(crate) fn point_of(point: &Bound<'_, PyAny>) -> PyResult<InputPoint> {
    if let Ok(text) = point.extract::<&str>() {
        return text.parse().map_err(|fault: ParsePointError| Exception::PointError.with(fault));
    }
    Ok(InputPoint::Vertex(vertex_of(point)?))
}

/// A vertex of the input by its number. Truth values are none.
pub(crate) fn vertex_of(number: &Bound<'_, PyAny>) -> PyResult<VertexId> {
    match number.extract() {
        Ok(found) if !number.is_instance_of::<PyBool>() => vertex(found),
        _ => Err(not_a_point(number)),
    }
}

/// Pairs of vertices of the input, the rows of an n x 2 array.
pub(crate) fn pairs_of(pairs: &PyReadonlyArray2<'_, i64>) -> PyResult<Vec<[VertexId; 2]>> {
    let pairs = pairs.as_slice()?.as_chunks::<2>().0.iter();
    pairs.map(|[a, b]| Ok([vertex(*a)?, vertex(*b)?])).collect()
}

fn not_a_point(given: &Bound<'_, PyAny>) -> PyErr {
    let message = "is not a point; give the number of a vertex, or text such as \"17-42@0.3\"";
    Exception::PointError.with(format!("{given} {message}"))
}

pub(crate) fn vertex(number: i64) -> PyResult<VertexId> {
    u32::try_from(number).map(VertexId).map_err(|_| {
        Exception::PointError.with(format!("{number} is not a vertex; vertices are counted from 0"))
    })
}
