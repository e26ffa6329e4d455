//! Points of the input on the repaired surface, and back.

use ::surface::{FaceId, SurfacePoint, VertexId};
use nalgebra::{Point3, Vector3};

use super::point::{InputPoint, PointError};
use super::surface::Surface;

/// Barycentric coordinates below this are rounding: the point lies on the edge.
const ON_EDGE: f64 = 1e-12;

/// The weight of a vertex at the point of an edge.
fn weight(v: VertexId, [start, end]: [VertexId; 2], t: f64) -> f64 {
    if v == start { 1.0 - t } else { f64::from(u8::from(v == end)) * t }
}

/// Barycentric coordinates of a point that is in the face up to rounding.
fn within(weights: [f64; 3]) -> [f64; 3] {
    let weights = weights.map(|weight| if weight > ON_EDGE { weight } else { 0.0 });
    let sum: f64 = weights.iter().sum();
    weights.map(|weight| weight / sum)
}

impl Surface {
    /// The point of the repaired surface that a point of the input became.
    ///
    /// # Errors
    /// [`PointError::NoSuchPoint`] if the input has no such vertex, edge or face; [`PointError::Dropped`] if the repair
    /// dropped it.
    pub fn locate(&self, point: &InputPoint) -> Result<SurfacePoint, PointError> {
        let dropped = PointError::Dropped { point: *point };
        match *point {
            InputPoint::Vertex(vertex) => Ok(SurfacePoint::Vertex(self.repaired_vertex(vertex)?)),
            InputPoint::Edge { ends, t } => {
                let is_edge = |f: &&[VertexId; 3]| ends.iter().all(|end| f.contains(end));
                let [start, end] = [self.repaired_vertex(ends[0])?, self.repaired_vertex(ends[1])?];
                if let Some(edge) = self.intrinsic().topology().edge_between(start, end) {
                    return Ok(SurfacePoint::Edge { edge, t: if start < end { t } else { 1.0 - t } });
                }
                let face = self.input.faces.iter().find(is_edge).ok_or_else(|| self.input.no_such(*point))?;
                self.in_face(*face, face.map(|v| weight(v, ends, t))).ok_or(dropped)
            }
            InputPoint::Face { face, weights } => {
                let vertices =
                    self.input.faces.get(face.index()).ok_or_else(|| self.input.no_such(*point))?;
                self.in_face(*vertices, weights).ok_or(dropped)
            }
        }
    }

    /// A point of the face between three input vertices, unless the repair dropped the face.
    fn in_face(&self, vertices: [VertexId; 3], weights: [f64; 3]) -> Option<SurfacePoint> {
        let [a, b, c] = vertices.map(|v| self.repaired_vertex(v).ok());
        let (corners, sum) = ([a?, b?, c?], weights.iter().sum::<f64>());
        let weights = weights.map(|weight| weight / sum);
        self.between(corners, weights).or_else(|| {
            // The part of a face that was split in which the point lies deepest.
            let at = corners.iter().zip(weights).map(|(v, w)| self.mesh().positions[v.index()].coords * w);
            let point = Point3::from(at.sum::<Vector3<f64>>());
            let is_whole = |face: &[VertexId; 3]| face.iter().all(|v| corners.contains(v));
            let parts = self.parts.iter().filter(|[_, whole]| is_whole(whole));
            let weighted = parts.map(|[part, _]| (*part, self.weights(*part, point)));
            let depth = |weights: &[f64; 3]| weights.iter().copied().fold(f64::INFINITY, f64::min);
            let (part, weights) = weighted.max_by(|a, b| depth(&a.1).total_cmp(&depth(&b.1)))?;
            self.between(part, within(weights))
        })
    }

    /// The point with these weights of the corners of a face, if there is one between these vertices.
    fn between(&self, corners: [VertexId; 3], weights: [f64; 3]) -> Option<SurfacePoint> {
        let topology = self.intrinsic().topology();
        // The repair may have welded two corners, or reversed the face.
        let is_same = |face: &[VertexId; 3]| {
            corners.iter().all(|v| face.contains(v)) && face.iter().all(|v| corners.contains(v))
        };
        let around = topology.vertex_corners(corners[0]).iter().map(|corner| corner.face());
        let face = around.into_iter().find(|face| is_same(&topology.faces()[face.index()]))?;
        let weight = |v: VertexId| corners.iter().position(|corner| *corner == v).map_or(0.0, |i| weights[i]);
        Some(SurfacePoint::Face { face, barycentric: topology.faces()[face.index()].map(weight) })
    }

    /// The barycentric coordinates of a point in the plane of a face, negative outside.
    fn weights(&self, corners: [VertexId; 3], point: Point3<f64>) -> [f64; 3] {
        let [a, b, c] = corners.map(|v| self.mesh().positions[v.index()]);
        let unit = self.mesh().unit();
        let area = |p: Point3<f64>, q: Point3<f64>, r: Point3<f64>| ((q - p) / unit).cross(&((r - p) / unit));
        let whole = area(a, b, c);
        [area(point, b, c), area(a, point, c), area(a, b, point)]
            .map(|part| part.dot(&whole) / whole.norm_squared())
    }

    /// A point of the repaired surface, in the numbers of the input.
    ///
    /// # Errors
    /// [`PointError::OtherFaces`] on edges and faces of a surface that was [prepared](Self::for_description) or simplified.
    pub fn input_point(&self, point: SurfacePoint) -> Result<InputPoint, PointError> {
        let topology = self.intrinsic().topology();
        let other = PointError::OtherFaces { point };
        let whole = |face: FaceId| {
            let part = VertexId::sorted(topology.faces()[face.index()]);
            let parts = &self.parts;
            Some(parts[parts.binary_search_by_key(&part, |[part, _]| *part).ok()?][1])
        };
        let (face, barycentric) = match point {
            SurfacePoint::Vertex(vertex) => return Ok(InputPoint::Vertex(self.input_vertex(vertex))),
            _ if self.open_boundary.is_some() => return Err(other),
            SurfacePoint::Edge { edge, t } => {
                let ends = topology.edges()[edge.index()];
                let faces = topology.edge_corners(edge).iter().map(|corner| corner.face());
                // It may be new: between parts of one face, or between two faces that were split along it.
                let is_old =
                    |face: FaceId| whole(face).is_none_or(|f| ends.iter().all(|end| f.contains(end)));
                if faces.clone().any(is_old) {
                    return Ok(InputPoint::Edge { ends: ends.map(|v| self.input_vertex(v)), t });
                }
                let face = faces.clone().next().ok_or(other)?;
                (face, topology.faces()[face.index()].map(|v| weight(v, ends, t)))
            }
            SurfacePoint::Face { face, barycentric } => (face, barycentric),
        };
        let (vertices, barycentric) = match whole(face) {
            None => (topology.faces()[face.index()], barycentric),
            Some(corners) => {
                let point = self.position(SurfacePoint::Face { face, barycentric });
                (corners, within(self.weights(corners, point)))
            }
        };
        let slot = |v: VertexId| vertices.iter().position(|w| self.input.remap.to_new(v) == Some(*w));
        let faces = self.input.faces.iter().map(|input| input.map(slot)).enumerate();
        let mut found = faces.filter_map(|(i, [a, b, c])| Some((i, [a?, b?, c?])));
        let (i, slots) = found.find(|(_, [a, b, c])| a != b && b != c && c != a).ok_or(other)?;
        Ok(InputPoint::Face { face: FaceId::from(i), weights: slots.map(|slot| barycentric[slot]) })
    }

    /// The position of a point of the repaired surface.
    pub fn position(&self, point: SurfacePoint) -> Point3<f64> {
        let at = |v: VertexId| self.mesh().positions[v.index()].coords;
        let topology = self.intrinsic().topology();
        Point3::from(match point {
            SurfacePoint::Vertex(vertex) => at(vertex),
            SurfacePoint::Edge { edge, t } => {
                let [a, b] = topology.edges()[edge.index()].map(at);
                a + (b - a) * t
            }
            SurfacePoint::Face { face, barycentric: [u, v, w] } => {
                let [a, b, c] = topology.faces()[face.index()].map(at);
                a * u + b * v + c * w
            }
        })
    }
}
