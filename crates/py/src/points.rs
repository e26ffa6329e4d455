//! Points of a surface as Python writes them.

use canonform::InputPoint;
use canonform::surface::VertexId;
use pyo3::prelude::*;

use crate::error::Exception;

/// Points of the input: vertex numbers, or text such as `17-42@0.3`.
pub(crate) fn points_of(points: &Bound<'_, PyAny>) -> PyResult<Vec<InputPoint>> {
    points.try_iter()?.map(|point| point_of(&point?)).collect()
}

pub(crate) fn point_of(point: &Bound<'_, PyAny>) -> PyResult<InputPoint> {
    if let Ok(text) = point.extract::<&str>() {
        return text.parse().map_err(|fault: canonform::BadPoint| Exception::Point.with(&fault.to_string()));
    }
    Ok(InputPoint::Vertex(vertex(point.extract()?)?))
}

pub(crate) fn vertex(number: i64) -> PyResult<VertexId> {
    u32::try_from(number)
        .map(VertexId)
        .map_err(|_| Exception::Point.with(&format!("{number} is not a vertex; vertices are counted from 0")))
}
