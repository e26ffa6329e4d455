//! Shortest paths in space, in the numbers of the input.

use geodesics::{GeodesicError, PathTracer, SurfacePoint};
use nalgebra::Point3;

use crate::{InputPoint, PipelineError, Surface};

/// A shortest path along a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePath {
    /// Its points from the source to the target, straight in between.
    pub points: Vec<PathPoint>,
    /// Its length, in mesh units.
    pub length: f64,
}

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// Where it is on the input.
    pub at: InputPoint,
    /// Where it is in space.
    pub position: Point3<f64>,
    /// How far it is from the source along the path, in mesh units.
    pub distance: f64,
}

impl Surface {
    /// The shortest path from the nearest source of `tracer`, which must be one of this surface, to a
    /// point.
    ///
    /// # Errors
    /// [`PipelineError::NoWay`], and [`PipelineError::Geodesic`] when the point is on another surface.
    pub fn path(&self, tracer: &PathTracer, target: SurfacePoint) -> Result<SurfacePath, PipelineError> {
        let path = tracer.path_to(target).map_err(|fault| match fault {
            GeodesicError::NoWay { point } => PipelineError::NoWay { target: self.input_point(point) },
            fault => fault.into(),
        })?;
        let mut points: Vec<PathPoint> = Vec::with_capacity(path.points.len());
        for point in path.points {
            let position = self.position(point);
            let step = points.last().map_or(0.0, |last| last.distance + (position - last.position).norm());
            points.push(PathPoint { at: self.input_point(point), position, distance: step });
        }
        Ok(SurfacePath { points, length: path.length })
    }
}
