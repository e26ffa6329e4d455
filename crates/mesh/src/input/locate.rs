//! Points of the input on the repaired surface, and back.

use ::surface::{EdgeId, FaceId, SurfacePoint, VertexId};
use nalgebra::Point3;

use super::point::{InputPoint, PointError};
use super::surface::Surface;

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
                match self.intrinsic().topology().edge_between(start, end) {
                    Some(edge) => Ok(SurfacePoint::Edge { edge, t: if start < end { t } else { 1.0 - t } }),
                    None if self.input_faces.iter().any(|f| is_edge(&f)) => Err(dropped),
                    None => Err(self.no_such(*point)),
                }
            }
            InputPoint::Face { face, weights } => {
                let vertices = self.input_faces.get(face.index()).ok_or_else(|| self.no_such(*point))?;
                self.in_face(*vertices, weights).ok_or(dropped)
            }
        }
    }

    /// A point of the face between three input vertices, unless the repair dropped the face.
    fn in_face(&self, vertices: [VertexId; 3], weights: [f64; 3]) -> Option<SurfacePoint> {
        let topology = self.intrinsic().topology();
        let corners = vertices.map(|v| self.repaired_vertex(v).ok());
        let corner = topology.vertex_corners(corners[0]?).iter().find(|corner| {
            let face = topology.faces()[corner.face().index()];
            corners.iter().all(|v| v.is_some_and(|v| face.contains(&v)))
        })?;
        let sum: f64 = weights.iter().sum();
        let weight = |vertex: VertexId| {
            corners.iter().zip(weights).find(|(v, _)| **v == Some(vertex)).map_or(0.0, |(_, w)| w / sum)
        };
        // The repair may have welded two corners, or reversed the face.
        let face = topology.faces()[corner.face().index()];
        let is_whole = face.iter().all(|v| corners.contains(&Some(*v)));
        is_whole.then(|| SurfacePoint::Face { face: corner.face(), barycentric: face.map(weight) })
    }

    /// A point of the repaired surface, in the numbers of the input.
    pub fn input_point(&self, point: SurfacePoint) -> InputPoint {
        let ends =
            |edge: EdgeId| self.intrinsic().topology().edges()[edge.index()].map(|v| self.input_vertex(v));
        match point {
            SurfacePoint::Vertex(vertex) => InputPoint::Vertex(self.input_vertex(vertex)),
            SurfacePoint::Edge { edge, t } => InputPoint::Edge { ends: ends(edge), t },
            SurfacePoint::Face { face, barycentric } => {
                let vertices = self.intrinsic().topology().faces()[face.index()];
                let to_repaired = |v: VertexId| self.repaired.input_to_repaired[v.index()];
                let slot = |v: VertexId| vertices.iter().position(|w| to_repaired(v) == Some(*w));
                let faces = self.input_faces.iter().map(|input| input.map(slot)).enumerate();
                let mut found = faces.filter_map(|(i, [a, b, c])| Some((i, [a?, b?, c?])));
                match found.find(|(_, [a, b, c])| a != b && b != c && c != a) {
                    Some((i, slots)) => InputPoint::Face {
                        face: FaceId::from(i),
                        weights: slots.map(|slot| barycentric[slot]),
                    },
                    None => unreachable!("the repair adds no faces"),
                }
            }
        }
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

#[cfg(test)]
mod tests {
    use crate::{Orient, RepairOptions, TriMesh, shapes};

    use super::*;

    fn point(text: &str) -> InputPoint {
        text.parse().unwrap()
    }

    /// A separate face and a degenerate one, then a torus with a crack and every second face reversed.
    fn broken() -> TriMesh {
        let mut mesh = shapes::disjoint(&[shapes::grid(2, 2, 0.01), shapes::torus(9, 7, 2.0, 0.5)]);
        mesh.faces[0] = [0, 1, 1].map(VertexId);
        for face in mesh.faces.iter_mut().skip(2).step_by(2) {
            face.swap(1, 2);
        }
        let twin = VertexId::from(mesh.n_vertices());
        mesh.positions.push(mesh.positions[10]);
        let faces = mesh.faces.iter_mut().filter(|f| f.contains(&VertexId(10)));
        faces.take(2).flatten().filter(|v| **v == VertexId(10)).for_each(|v| *v = twin);
        mesh
    }

    #[test]
    fn points_keep_their_positions_through_every_repair() {
        let mesh = broken();
        let options = RepairOptions { orient: Orient::Consistent, ..RepairOptions::default() };
        let surface = Surface::new(&mesh, &options, &()).unwrap();
        let at = |v: VertexId| mesh.positions[v.index()].coords;
        for (f, [a, b, c]) in mesh.faces.iter().enumerate().skip(2) {
            for (text, expected) in [
                (format!("{b}"), at(*b)),
                (format!("{a}-{b}@0.3"), at(*a) * 0.7 + at(*b) * 0.3),
                (format!("{b}-{a}@0.3"), at(*a) * 0.3 + at(*b) * 0.7),
                (format!("f{f}@1:2:5"), (at(*a) + at(*b) * 2.0 + at(*c) * 5.0) / 8.0),
            ] {
                let found = surface.locate(&point(&text)).unwrap();
                assert!((surface.position(found).coords - expected).norm() < 1e-14, "{text}");
                // Welded twins have one name, so compare positions.
                let again = surface.locate(&surface.input_point(found)).unwrap();
                assert!((surface.position(again).coords - expected).norm() < 1e-14, "{text}");
            }
        }
    }

    #[test]
    fn missing_and_dropped_elements_are_different_errors() {
        let mut mesh = broken();
        // Two corners of this face coincide.
        let n = mesh.n_faces();
        let [kept, twin] = [VertexId(10), VertexId::from(mesh.n_vertices() - 1)];
        mesh.faces.push([kept, twin, VertexId(11)]);
        let surface = Surface::new(&mesh, &RepairOptions::default(), &()).unwrap();
        let fault = |text: &str| surface.locate(&point(text)).unwrap_err();
        assert!(matches!(fault("999"), PointError::NoSuchPoint { .. }));
        assert!(matches!(fault("3"), PointError::Dropped { .. }));
        assert!(matches!(fault("f999"), PointError::NoSuchPoint { .. }));
        for dropped in ["f0", "f1", &format!("f{n}")] {
            assert!(matches!(fault(dropped), PointError::Dropped { .. }), "{dropped}");
        }
        assert!(matches!(fault("4-40"), PointError::NoSuchPoint { .. }));
        assert!(matches!(fault(&format!("{kept}-{twin}")), PointError::Dropped { .. }));
    }
}
