//! Points of a surface as people write them, in the numbers of the input.

use std::fmt;
use std::str::FromStr;

use geodesics::SurfacePoint;
use nalgebra::Point3;
use serde::{Serialize, Serializer};
use surface::{EdgeId, FaceId, VertexId};

use crate::{PipelineError, Surface};

/// A point of the input: `17`, a vertex; `17-42@0.3`, the point 0.3 of the way from vertex 17 to vertex
/// 42 along their edge; `f8@2:1:1`, the point of face 8 with these weights of its corners, in the order
/// of the file. Without `@` the middle of the edge or of the face is meant. Vertices and faces are
/// counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InputPoint {
    /// A vertex.
    Vertex(VertexId),
    /// A point of an edge.
    Edge {
        /// Where the edge starts and ends.
        ends: [VertexId; 2],
        /// Share of the way, in 0..=1.
        t: f64,
    },
    /// A point of a face.
    Face {
        /// The face.
        face: FaceId,
        /// Weights of its corners, not negative and with a positive sum.
        weights: [f64; 3],
    },
}

impl FromStr for InputPoint {
    type Err = PipelineError;

    fn from_str(text: &str) -> Result<Self, PipelineError> {
        parse(text.trim()).ok_or_else(|| PipelineError::BadPoint { text: text.to_owned() })
    }
}

fn parse(text: &str) -> Option<InputPoint> {
    let (element, place) = match text.split_once('@') {
        Some((element, place)) => (element, Some(place)),
        None => (text, None),
    };
    if let Some(face) = element.strip_prefix('f') {
        let mut weights = [1.0; 3];
        if let Some(place) = place {
            let mut parts = place.split(':');
            for weight in &mut weights {
                *weight = parts.next()?.parse().ok()?;
            }
            if parts.next().is_some() {
                return None;
            }
        }
        let sum: f64 = weights.iter().sum();
        let is_inside = weights.iter().all(|w| *w >= 0.0) && sum > 0.0 && sum.is_finite();
        let face = FaceId(face.parse().ok()?);
        return is_inside.then_some(InputPoint::Face { face, weights });
    }
    if let Some((start, end)) = element.split_once('-') {
        let t = place.map_or(Some(0.5), |place| place.parse().ok())?;
        let ends = [VertexId(start.parse().ok()?), VertexId(end.parse().ok()?)];
        return ((0.0..=1.0).contains(&t) && ends[0] != ends[1]).then_some(InputPoint::Edge { ends, t });
    }
    match place {
        None => Some(InputPoint::Vertex(VertexId(element.parse().ok()?))),
        Some(_) => None,
    }
}

impl fmt::Display for InputPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Vertex(vertex) => vertex.fmt(f),
            Self::Edge { ends: [start, end], t } => write!(f, "{start}-{end}@{t}"),
            Self::Face { face, weights: [u, v, w] } => write!(f, "f{face}@{u}:{v}:{w}"),
        }
    }
}

impl Serialize for InputPoint {
    /// A vertex as a number, anything else as text.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Vertex(vertex) => vertex.serialize(serializer),
            _ => serializer.collect_str(self),
        }
    }
}

impl Surface {
    /// Where a point of the input is on the repaired surface.
    ///
    /// # Errors
    /// [`PipelineError::NoSuchVertex`], [`PipelineError::NoSuchEdge`] and [`PipelineError::NoSuchFace`] for
    /// what the input does not have; [`PipelineError::DroppedVertex`], [`PipelineError::DroppedEdge`] and
    /// [`PipelineError::DroppedFace`] for what the repair has left out.
    pub fn locate(&self, point: &InputPoint) -> Result<SurfacePoint, PipelineError> {
        match *point {
            InputPoint::Vertex(vertex) => Ok(SurfacePoint::Vertex(self.repaired_vertex(vertex)?)),
            InputPoint::Edge { ends, t } => {
                let is_edge = |f: &&[VertexId; 3]| ends.iter().all(|end| f.contains(end));
                let [start, end] = [self.repaired_vertex(ends[0])?, self.repaired_vertex(ends[1])?];
                match self.intrinsic.topology().edge_between(start, end) {
                    Some(edge) => Ok(SurfacePoint::Edge { edge, t: if start < end { t } else { 1.0 - t } }),
                    None if self.input_faces.iter().any(|f| is_edge(&f)) => {
                        Err(PipelineError::DroppedEdge { ends })
                    }
                    None => Err(PipelineError::NoSuchEdge { ends }),
                }
            }
            InputPoint::Face { face, weights } => {
                let n_faces = self.input_faces.len();
                let vertices = self.input_faces.get(face.index());
                let vertices = vertices.ok_or(PipelineError::NoSuchFace { face, n_faces })?;
                self.in_face(*vertices, weights).ok_or(PipelineError::DroppedFace { face })
            }
        }
    }

    /// A point of the face between three input vertices, if the repair has left it.
    fn in_face(&self, vertices: [VertexId; 3], weights: [f64; 3]) -> Option<SurfacePoint> {
        let topology = self.intrinsic.topology();
        let corners = vertices.map(|v| self.repaired_vertex(v).ok());
        let corner = topology.vertex_corners(corners[0]?).iter().find(|corner| {
            let face = topology.faces()[corner.face().index()];
            corners.iter().all(|v| v.is_some_and(|v| face.contains(&v)))
        })?;
        let sum: f64 = weights.iter().sum();
        let weight = |vertex: VertexId| {
            corners.iter().zip(weights).find(|(v, _)| **v == Some(vertex)).map_or(0.0, |(_, w)| w / sum)
        };
        // Repair may have welded two corners into one, or turned the face over.
        let face = topology.faces()[corner.face().index()];
        let is_whole = face.iter().all(|v| corners.contains(&Some(*v)));
        is_whole.then(|| SurfacePoint::Face { face: corner.face(), barycentric: face.map(weight) })
    }

    /// A point of the repaired surface in the numbers of the input.
    #[must_use]
    pub fn input_point(&self, point: SurfacePoint) -> InputPoint {
        let ends =
            |edge: EdgeId| self.intrinsic.topology().edges()[edge.index()].map(|v| self.input_vertex(v));
        match point {
            SurfacePoint::Vertex(vertex) => InputPoint::Vertex(self.input_vertex(vertex)),
            SurfacePoint::Edge { edge, t } => InputPoint::Edge { ends: ends(edge), t },
            SurfacePoint::Face { face, barycentric } => {
                let vertices = self.intrinsic.topology().faces()[face.index()];
                let to_repaired = |v: VertexId| self.repaired.input_to_repaired[v.index()];
                let slot = |v: VertexId| vertices.iter().position(|w| to_repaired(v) == Some(*w));
                let faces = self.input_faces.iter().map(|input| input.map(slot)).enumerate();
                let mut found = faces.filter_map(|(i, [a, b, c])| Some((i, [a?, b?, c?])));
                match found.find(|(_, [a, b, c])| a != b && b != c && c != a) {
                    Some((i, slots)) => InputPoint::Face {
                        face: FaceId::from(i),
                        weights: slots.map(|slot| barycentric[slot]),
                    },
                    None => unreachable!("repair makes no faces"),
                }
            }
        }
    }

    /// Where in space a point of the repaired surface is.
    #[must_use]
    pub fn position(&self, point: SurfacePoint) -> Point3<f64> {
        let at = |v: VertexId| self.mesh().positions[v.index()].coords;
        let topology = self.intrinsic.topology();
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
    use mesh::{Orient, RepairOptions, TriMesh, shapes};

    use super::*;

    fn point(text: &str) -> InputPoint {
        text.parse().unwrap()
    }

    #[test]
    fn points_are_written_as_they_are_read() {
        for text in ["17", "17-42@0.3", "0-1@1", "f8@2:1:1", "f0@0:0.125:7"] {
            assert_eq!(point(text).to_string(), text);
        }
        assert_eq!(point(" 4-7 "), point("4-7@0.5"));
        assert_eq!(point("f9"), point("f9@1:1:1"));
        for text in
            ["", "x", "1.5", "1-", "-1", "1-2@2", "1-1", "1@0", "f", "f1@1", "f1@1:1:inf", "f1@nan:1:1"]
        {
            let error = text.parse::<InputPoint>().unwrap_err();
            assert!(error.to_string().contains(&format!("`{text}`")), "{text}");
        }
    }

    /// A face apart and one that names a vertex twice, then a torus with a crack and every second face
    /// turned over.
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
    fn points_are_found_where_they_are_whatever_was_repaired() {
        let mesh = broken();
        let options = RepairOptions { orient: Orient::Consistent, ..RepairOptions::default() };
        let surface = Surface::new(&mesh, &options).unwrap();
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
                // There and back, but for the twins.
                let again = surface.locate(&surface.input_point(found)).unwrap();
                assert!((surface.position(again).coords - expected).norm() < 1e-14, "{text}");
            }
        }
    }

    #[test]
    fn what_is_not_there_or_was_left_out_is_told_apart() {
        let mut mesh = broken();
        // Two corners of this one are in one place.
        let n = mesh.n_faces();
        let [kept, twin] = [VertexId(10), VertexId::from(mesh.n_vertices() - 1)];
        mesh.faces.push([kept, twin, VertexId(11)]);
        let surface = Surface::new(&mesh, &RepairOptions::default()).unwrap();
        let fault = |text: &str| surface.locate(&point(text)).unwrap_err();
        assert!(matches!(fault("999"), PipelineError::NoSuchVertex { .. }));
        assert!(matches!(fault("3"), PipelineError::DroppedVertex { .. }));
        assert!(matches!(fault("f999"), PipelineError::NoSuchFace { .. }));
        for dropped in ["f0", "f1", &format!("f{n}")] {
            assert!(matches!(fault(dropped), PipelineError::DroppedFace { .. }), "{dropped}");
        }
        assert!(matches!(fault("4-40"), PipelineError::NoSuchEdge { .. }));
        assert!(matches!(fault(&format!("{kept}-{twin}")), PipelineError::DroppedEdge { .. }));
    }
}
