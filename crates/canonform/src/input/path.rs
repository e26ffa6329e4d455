//! Shortest paths, in the numbers of the input.

use geodesics::{GeodesicError, PathTracer, SurfacePoint};
use nalgebra::Point3;

use mesh::{InputPoint, Surface};

use crate::error::Error;

/// A shortest path along a surface.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfacePath {
    /// Its points from the source to the target, joined by straight lines.
    pub points: Vec<PathPoint>,
    /// Its length, in mesh units.
    pub length: f64,
}

/// A point of a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PathPoint {
    /// The point of the input.
    pub at: InputPoint,
    /// Its position.
    pub position: Point3<f64>,
    /// Distance from the source along the path, in mesh units.
    pub distance: f64,
}

impl SurfacePath {
    /// The shortest path from the nearest source of `tracer` to a point. The tracer must belong to the surface.
    ///
    /// # Errors
    /// [`Error::NoPath`], and [`Error::Geodesic`] if the point belongs to another surface.
    pub fn trace(surface: &Surface, tracer: &PathTracer, target: SurfacePoint) -> Result<Self, Error> {
        let path = match tracer.path_to(target) {
            Err(GeodesicError::NoPath { point }) => {
                return Err(Error::NoPath { target: surface.input_point(point)?.to_string() });
            }
            path => path?,
        };
        let mut points: Vec<PathPoint> = Vec::with_capacity(path.points.len());
        for point in path.points {
            let position = surface.position(point);
            let step = points.last().map_or(0.0, |last| last.distance + (position - last.position).norm());
            points.push(PathPoint { at: surface.input_point(point)?, position, distance: step });
        }
        Ok(Self { points, length: path.length })
    }
}
