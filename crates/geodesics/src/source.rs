//! Sources: the points that distances are measured from.

use surface::{IntrinsicMesh, NearestFirst, SurfacePoint, VertexId};

use crate::error::GeodesicError;
use crate::plane::{between, distance, dot, sub};
use crate::sight::{Rays, SeenFace, faces_seen_from};

/// A point that distances are measured from, with its straight distances to the vertices that it sees nearby.
///
/// ```
/// use canonform_geodesics::{Source, SurfacePoint};
/// use mesh::shapes;
/// use surface::FaceId;
///
/// let mesh = shapes::icosphere(2).intrinsic();
/// let center = SurfacePoint::Face { face: FaceId(7), barycentric: [1.0 / 3.0; 3] };
/// let source = Source::new(&mesh, center)?;
/// assert_eq!(source.reach().len(), 3);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    point: SurfacePoint,
    /// Of these, the vertices of its own faces come first.
    seen: Vec<(VertexId, f64)>,
    n_own: usize,
}

/// Rounding allowed in the sum of barycentric coordinates.
const BARYCENTRIC_SLACK: f64 = 1e-9;

/// How far a point looks around, in lengths to the farthest vertex of its own faces, and the most bundles of rays followed. Where
/// edges are flipped, the triangle around the point has vertices beyond these faces, nearly always within this reach.
const AROUND: f64 = 2.0;
const MAX_RAYS: usize = 500;

impl Source {
    /// A vertex.
    pub fn vertex(vertex: VertexId) -> Self {
        Self { point: SurfacePoint::Vertex(vertex), seen: vec![(vertex, 0.0)], n_own: 1 }
    }

    /// The same source of the same surface with all lengths divided by `unit`.
    pub(crate) fn in_units_of(&self, unit: f64) -> Self {
        Self { seen: self.seen.iter().map(|&(v, length)| (v, length / unit)).collect(), ..*self }
    }

    /// Any point of a surface.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`] and [`GeodesicError::BadPoint`].
    pub fn new(mesh: &IntrinsicMesh, point: SurfacePoint) -> Result<Self, GeodesicError> {
        let topology = mesh.topology();
        let bad = |why| Err(GeodesicError::BadPoint(why));
        match point {
            SurfacePoint::Vertex(vertex) => {
                if vertex.index() >= mesh.n_vertices() {
                    return Err(GeodesicError::NoSuchVertex { vertex, n_vertices: mesh.n_vertices() });
                }
            }
            SurfacePoint::Edge { edge, t } => {
                if edge.index() >= topology.n_edges() {
                    return bad(format!("edge {edge} of {}", topology.n_edges()));
                }
                if !(0.0..=1.0).contains(&t) {
                    return bad(format!("the position {t} along an edge is not in 0..=1"));
                }
            }
            SurfacePoint::Face { face, barycentric } => {
                if face.index() >= topology.n_faces() {
                    return bad(format!("face {face} of {}", topology.n_faces()));
                }
                let sum: f64 = barycentric.iter().sum();
                let whole = (1.0 - BARYCENTRIC_SLACK..=1.0 + BARYCENTRIC_SLACK).contains(&sum);
                if barycentric.iter().any(|b| *b < 0.0) || !whole {
                    return bad(format!(
                        "barycentric coordinates {barycentric:?} are negative or do not sum to 1"
                    ));
                }
            }
        }
        let point = point.simplified(mesh);
        // The vertices of its edge or face come first.
        let own: &[VertexId] = match point {
            SurfacePoint::Vertex(vertex) => return Ok(Self::vertex(vertex)),
            SurfacePoint::Edge { edge, .. } => &topology.edges()[edge.index()],
            SurfacePoint::Face { face, .. } => &topology.faces()[face.index()],
        };
        let mut sight = Sight::default();
        sight.vertices.extend(own.iter().map(|v| (*v, f64::INFINITY)));
        faces_seen_from(mesh, point).iter().for_each(|seen| sight.enter(seen));
        let n_own = sight.vertices.len();
        let farthest = sight.vertices.iter().map(|(_, length)| *length).fold(0.0, f64::max);
        while let Some((nearest, number)) = sight.queue.pop()
            && nearest <= AROUND * farthest
            && sight.rays.len() < MAX_RAYS
        {
            let rays = sight.rays[number];
            rays.faces_beyond(mesh, number).for_each(|seen| sight.enter(&seen));
        }
        Ok(Self { point, seen: sight.vertices, n_own })
    }

    /// The point: a vertex or a point of an edge if it is one.
    pub fn point(&self) -> SurfacePoint {
        self.point
    }

    /// The vertices of the faces that contain the point, with their distances from it inside these faces, in mesh
    /// units; of a vertex only itself.
    pub fn reach(&self) -> &[(VertexId, f64)] {
        &self.seen[..self.n_own]
    }

    /// These, and further ones with the length of a straight line to each, which may cross other faces.
    pub(crate) fn seen(&self) -> &[(VertexId, f64)] {
        &self.seen
    }
}

/// What a point sees around it.
#[derive(Default)]
struct Sight {
    vertices: Vec<(VertexId, f64)>,
    rays: Vec<Rays>,
    /// The nearest first.
    queue: NearestFirst<usize>,
}

impl Sight {
    fn enter(&mut self, seen: &SeenFace) {
        let vertices = seen.flat.vertices.into_iter().zip(seen.flat.at).zip(seen.is_visible);
        for ((vertex, at), _) in vertices.filter(|(_, is_visible)| *is_visible) {
            let length = distance(at, [0.0; 2]);
            match self.vertices.iter_mut().find(|(known, _)| *known == vertex) {
                Some((_, known)) => *known = known.min(length),
                None => self.vertices.push((vertex, length)),
            }
        }
        for rays in seen.onward.iter().flatten() {
            let [p, q] = rays.span();
            let along = sub(q, p);
            let t = -dot(p, along) / dot(along, along);
            let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
            self.queue.push(distance(between(p, q, t), [0.0; 2]), self.rays.len());
            self.rays.push(*rays);
        }
    }
}

/// Two straight lengths are measured from one point of a triangle if they agree to this share; others lead around a vertex.
const SAME_POINT: f64 = 1e-6;

/// The barycentric coordinates of the point of a triangle at these distances from its corners, none of them negative but by
/// rounding; none if no point of the triangle is. Its base runs from the first corner along the x-axis to the second.
pub(crate) fn point_within([base, x, y]: [f64; 3], distances: [f64; 3]) -> Option<[f64; 3]> {
    // Differences of two squared distances are linear in the point.
    let [a, b, c] = distances.map(|distance| distance * distance);
    let along = 0.5 * (base + (a - b) / base);
    let up = 0.5 * (x * x + y * y + a - c - 2.0 * x * along) / y;
    let third = up / y;
    let second = (along - x * third) / base;
    let shares = [1.0 - second - third, second, third];
    let is_one =
        (along.hypot(up) - distances[0]).abs() <= SAME_POINT * distances.into_iter().fold(base, f64::max);
    (is_one && shares.iter().all(|share| *share >= -SAME_POINT)).then_some(shares)
}

#[cfg(test)]
mod tests {
    use super::*;
    use mesh::shapes::grid;
    use surface::{EdgeId, FaceId};

    #[test]
    fn points_off_the_surface_are_rejected() {
        let mesh = grid(2, 2, 1.0).intrinsic();
        for point in [
            SurfacePoint::Edge { edge: EdgeId(9), t: 0.5 },
            SurfacePoint::Edge { edge: EdgeId(0), t: 1.5 },
            SurfacePoint::Edge { edge: EdgeId(0), t: f64::NAN },
            SurfacePoint::Face { face: FaceId(2), barycentric: [1.0, 0.0, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [0.5, 0.0, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [1.5, -0.5, 0.0] },
            SurfacePoint::Face { face: FaceId(0), barycentric: [f64::NAN, 0.5, 0.5] },
        ] {
            assert!(matches!(Source::new(&mesh, point), Err(GeodesicError::BadPoint(_))), "{point:?}");
        }
        let vertex = SurfacePoint::Vertex(VertexId(4));
        assert!(matches!(Source::new(&mesh, vertex), Err(GeodesicError::NoSuchVertex { .. })));
    }
}
