//! Points of a mesh as people write them, in the numbers of the input.

use std::fmt;
use std::str::FromStr;

use ::surface::{FaceId, SurfacePoint, VertexId};
use serde::{Serialize, Serializer};

/// A point of the input mesh, written as
///
/// * `17`: vertex 17;
/// * `17-42@0.3`: the point on the edge from vertex 17 to vertex 42, at 0.3 of its length;
/// * `f8@2:1:1`: the point of face 8 with these weights of its corners, in the order of the file.
///
/// Without `@`, the midpoint of the edge or of the face. Vertices and faces are counted from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum InputPoint {
    /// A vertex.
    Vertex(VertexId),
    /// A point of an edge.
    Edge {
        /// Start and end of the edge.
        ends: [VertexId; 2],
        /// Position as a share of the edge, in 0..=1.
        t: f64,
    },
    /// A point of a face.
    Face {
        /// The face.
        face: FaceId,
        /// Weights of its corners: nonnegative, with a positive sum.
        weights: [f64; 3],
    },
}

/// Text that is not a point of a mesh.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is not a point of a mesh; write 17 for a vertex (counted from 0), 17-42@0.3 for a point on an edge (at 0.3 of the \
     length from 17 to 42), or f8@2:1:1 for a point of a face with these weights of its corners"
)]
pub struct ParsePointError {
    /// The text.
    pub text: String,
}

/// A point that the surface does not have.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum PointError {
    /// A point of a vertex, edge or face that the input does not have.
    #[error(
        "{element} does not exist; the mesh has {n_faces} faces and {n_vertices} vertices, counted from 0",
        element = point.element()
    )]
    NoSuchPoint {
        /// The point.
        point: InputPoint,
        /// Vertices of the input.
        n_vertices: usize,
        /// Faces of the input.
        n_faces: usize,
    },
    /// A point of a vertex, edge or face of the input that the repair dropped.
    #[error(
        "{element} was left out by the repair: it is degenerate, without a face, or not in the largest component; \
         choose another point",
        element = point.element()
    )]
    Dropped {
        /// The point.
        point: InputPoint,
    },
    /// A point of a surface whose faces are not those of the input, since it was prepared for a description or simplified.
    #[error(
        "{point} is on no face of the input: the surface has other faces; measure on the repaired surface"
    )]
    OtherFaces {
        /// The point.
        point: SurfacePoint,
    },
}

impl FromStr for InputPoint {
    type Err = ParsePointError;

    fn from_str(text: &str) -> Result<Self, ParsePointError> {
        parse(text.trim()).ok_or_else(|| ParsePointError { text: text.to_owned() })
    }
}

impl InputPoint {
    /// Its vertex, edge or face, in words.
    fn element(&self) -> String {
        match self {
            Self::Vertex(vertex) => format!("vertex {vertex}"),
            Self::Edge { ends: [start, end], .. } => format!("edge {start}-{end}"),
            Self::Face { face, .. } => format!("face {face}"),
        }
    }
}

fn parse(text: &str) -> Option<InputPoint> {
    let mut parts = text.splitn(2, '@');
    let (element, place) = (parts.next()?, parts.next());
    if let Some(face) = element.strip_prefix('f') {
        let weights = place.unwrap_or("1:1:1").split(':').map(|weight| weight.parse().ok());
        let weights: [f64; 3] = weights.collect::<Option<Vec<f64>>>()?.try_into().ok()?;
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
    /// Writes a vertex as a number, any other point as text.
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Vertex(vertex) => vertex.serialize(serializer),
            _ => serializer.collect_str(self),
        }
    }
}
