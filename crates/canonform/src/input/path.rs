//! Shortest paths, in the numbers of the input.

use geodesics::{GeodesicError, PathTracer};
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
    /// The shortest path from the nearest of some points, the sources of `tracer`, to another one. The tracer must belong to the
    /// surface. The ends of the path are named as they are given.
    ///
    /// # Errors
    /// [`Error::NoPath`], and [`Error::Point`] for a point that does not exist.
    pub fn trace(
        surface: &Surface,
        tracer: &PathTracer,
        from: &[InputPoint],
        to: InputPoint,
    ) -> Result<Self, Error> {
        let path = match tracer.path_to(surface.locate(&to)?) {
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
        if let [first, ..] = &mut points[..] {
            let start = first.position;
            let mut nearest = f64::INFINITY;
            for source in from {
                let apart = (surface.position(surface.locate(source)?) - start).norm();
                if apart < nearest {
                    (nearest, first.at) = (apart, *source);
                }
            }
        }
        points.iter_mut().last().into_iter().for_each(|last| last.at = to);
        Ok(Self { points, length: path.length })
    }
}
