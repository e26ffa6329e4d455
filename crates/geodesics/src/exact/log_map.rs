//! The logarithmic map: where points lie around another one, by the direction and the length of their shortest paths.

use base::Observer;
use surface::{IntrinsicMesh, SurfacePoint};

use super::bearing::Direction;
use super::prepared::PreparedSurface;
use super::propagation::{self, ExactScratch};
use super::tangent_plane::TangentPlane;
use crate::error::GeodesicError;
use crate::source::Source;

/// The logarithmic map of every vertex about a source: a vector in the tangent plane of the source, in mesh units, that points
/// along the shortest path to the vertex and is as long as it.
///
/// * **Axes.** The first one points, from a vertex, along the edge to its neighbor with the lowest number; from a point of an
///   edge, to the higher end; in a face, from its first corner to the second. The second one is 90 degrees to the left, as the
///   faces are oriented.
/// * **Angles.** Those between edges at an interior vertex are scaled, so that they sum to 360 degrees. All others are kept: the
///   map of a flat surface is flat.
/// * Not a number for vertices beyond `max_distance`, on other components, and where the path begins with a link, which has no
///   direction.
///
/// Takes the time of one map of [`Exact`](crate::Exact) distances, whose windows carry the direction of their paths.
///
/// # Errors
/// Those of [`Source::new`], and [`GeodesicError::Exceeded`].
///
/// ```
/// use canonform_geodesics::{SurfacePoint, log_map};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // A sheet of 4 x 3 vertices a unit apart: the first axis points from vertex 0 to vertex 1.
/// let sheet = shapes::grid(4, 3, 1.0).intrinsic();
/// let map = log_map(&sheet, SurfacePoint::Vertex(VertexId(0)), f64::INFINITY, &())?;
/// assert!((map[11][0] - 3.0).abs() < 1e-12 && (map[11][1] - 2.0).abs() < 1e-12);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
pub fn log_map(
    mesh: &IntrinsicMesh,
    point: SurfacePoint,
    max_distance: f64,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 2]>, GeodesicError> {
    let source = Source::new(mesh, point)?;
    let surface = PreparedSurface::new(mesh);
    let plane = TangentPlane::at(mesh, source.point()).renumbered(&surface);
    let mut scratch = ExactScratch::<Direction>::default();
    let (unit, budget) = (surface.faces.unit, observer.budget());
    let sources = (std::slice::from_ref(&source), &plane);
    let front = propagation::run(&surface, &mut scratch, max_distance, sources, &budget)?;
    let vector = |vertex: &u32| {
        let distance = front.distance(*vertex) * unit;
        let angle = match front.arrival(*vertex).1 {
            _ if distance == f64::INFINITY || distance > max_distance => f64::NAN,
            Direction::At(angle) => plane.scale * (angle - plane.zero),
            // The source itself.
            Direction::Open | Direction::Along { .. } => 0.0,
        };
        [distance * angle.cos(), distance * angle.sin()]
    };
    Ok(surface.new_vertices.iter().map(vector).collect())
}
