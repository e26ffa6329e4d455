//! The logarithmic map: where points lie around another one, by the direction and the length of their shortest paths.

use std::f64::consts::TAU;

use base::Observer;
use surface::{CornerId, EdgeId, FaceId, IntrinsicMesh, OneRing, SurfacePoint, VertexId, Winding};

use super::bearing::Direction;
use super::prepared::PreparedSurface;
use super::propagation::{self, ExactScratch};
use super::pseudo_sources::ON_EDGE;
use crate::error::GeodesicError;
use crate::path::Flat;
use crate::plane::{PlanePoint, sub};
use crate::source::Source;

/// The logarithmic map of every vertex about a source: a vector in the tangent plane of the source, in mesh units, that points
/// along the shortest path to the vertex and is as long as it.
///
/// * **Axes.** The first one points, from a vertex, along the edge to its neighbour with the lowest number; from a point of an
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
    mut point: SurfacePoint,
    max_distance: f64,
    observer: &dyn Observer,
) -> Result<Vec<[f64; 2]>, GeodesicError> {
    Source::new(mesh, point)?;
    if let SurfacePoint::Face { barycentric, .. } = &mut point {
        barycentric.iter_mut().filter(|share| **share < ON_EDGE).for_each(|share| *share = 0.0);
    }
    let source = Source::new(mesh, point.simplified(mesh))?;
    let surface = PreparedSurface::new(mesh);
    let plane = TangentPlane::at(mesh, source.point()).renumbered(&surface);
    let mut scratch = ExactScratch::<Direction>::default();
    let (unit, budget) = (surface.faces.unit, observer.budget());
    let sources = (std::slice::from_ref(&source), &plane);
    let front = propagation::run(
        &surface,
        &mut scratch,
        max_distance / unit,
        sources,
        surface.max_windows(),
        &budget,
    )?;
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

/// The faces around a point, unrolled into the plane that touches there.
#[derive(Debug)]
pub(super) struct TangentPlane {
    pub(super) sheets: Vec<Sheet>,
    /// The angle of the first axis.
    zero: f64,
    /// From angles on the surface to those in the plane.
    scale: f64,
}

/// A face of a tangent plane: it is laid out with the point in the origin, and an angle `a` there is `start + sign * a`.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) face: FaceId,
    pub(super) flat: Flat,
    pub(super) start: f64,
    pub(super) sign: f64,
}

impl TangentPlane {
    fn at(mesh: &IntrinsicMesh, point: SurfacePoint) -> Self {
        match point {
            SurfacePoint::Vertex(vertex) => Self::at_vertex(mesh, vertex),
            SurfacePoint::Edge { edge, .. } => Self::at_edge(mesh, point, edge),
            SurfacePoint::Face { face, .. } => {
                let flat = Flat::of_face(mesh, face).about(mesh, point);
                Self { sheets: vec![Sheet { face, flat, start: 0.0, sign: 1.0 }], zero: 0.0, scale: 1.0 }
            }
        }
    }

    /// The first face of the edge lies on the side that its orientation says, all others on the other side.
    fn at_edge(mesh: &IntrinsicMesh, point: SurfacePoint, edge: EdgeId) -> Self {
        let [low, high] = mesh.topology().edges()[edge.index()];
        let mut first = None;
        let sheet = |corner: &CornerId| {
            // The corner opposite the edge is in the origin, and its face to the left of the side from the next corner on.
            let side = if mesh.topology().corner_vertex(corner.next()) == low { 1.0 } else { -1.0 };
            let wanted = first.map_or(side, |first: f64| -first);
            first = first.or(Some(side));
            let (sign, flat) = (wanted * side, Flat::new(mesh, *corner).about(mesh, point));
            let along = angle_of(sub(flat.vertex(high), flat.vertex(low)));
            Sheet { face: corner.face(), flat, start: -sign * along, sign }
        };
        Self { sheets: mesh.topology().edge_corners(edge).iter().map(sheet).collect(), zero: 0.0, scale: 1.0 }
    }

    fn at_vertex(mesh: &IntrinsicMesh, vertex: VertexId) -> Self {
        let topology = mesh.topology();
        let mut ring = OneRing::default();
        ring.collect(topology, vertex);
        let (mut sheets, mut sides, mut total) = (Vec::new(), Vec::new(), 0.0);
        let mut orientation = (CornerId(u32::MAX), 1.0);
        for corner in ring.fans().flat_map(|fan| fan.corners) {
            let flat = Flat::new(mesh, corner.corner);
            let [start, end] = [total, total + angle_of(flat.at[2])];
            total = end;
            let ends = [corner.opposite_last(), corner.opposite_first()].map(|c| topology.corner_vertex(c));
            sides.extend([(ends[0], start), (ends[1], end)]);
            let (start, sign) = match corner.winding {
                Winding::Forward => (start, 1.0),
                Winding::Backward => (end, -1.0),
            };
            if corner.corner < orientation.0 {
                orientation = (corner.corner, sign);
            }
            sheets.push(Sheet { face: corner.corner.face(), flat, start, sign });
        }
        let zero = sides.iter().min_by_key(|(end, _)| *end).map_or(0.0, |(_, angle)| *angle);
        let scale = orientation.1 * if ring.is_closed() && total > 0.0 { TAU / total } else { 1.0 };
        Self { sheets, zero, scale }
    }

    /// The same with the numbers of a prepared surface.
    fn renumbered(mut self, surface: &PreparedSurface) -> Self {
        for Sheet { face, flat, .. } in &mut self.sheets {
            *face = FaceId(surface.new_faces[face.index()]);
            flat.vertices = flat.vertices.map(|v| VertexId(surface.new_vertices[v.index()]));
        }
        self
    }
}

impl Sheet {
    pub(super) fn place(&self, vertex: u32) -> Option<PlanePoint> {
        self.flat.vertices.iter().position(|v| v.0 == vertex).map(|slot| self.flat.at[slot])
    }
}

pub(super) fn angle_of([x, y]: PlanePoint) -> f64 {
    y.atan2(x)
}
