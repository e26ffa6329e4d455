//! Paths as nodes and the faces crossed between them.

use surface::{EdgeId, FaceId, IntrinsicMesh, VertexId};

use super::plane::{Flat, is_on, segment};
use crate::plane::{GateSide, PlanePoint, beyond};
use surface::SurfacePoint;

/// A path along the surface: nodes and the sections between them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct StripPath {
    pub(super) nodes: Vec<SurfacePoint>,
    /// One fewer than nodes.
    pub(super) sections: Vec<PathSection>,
}

/// The part of a path between two nodes: a link of the given length, or straight lines through faces.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum PathSection {
    Link(f64),
    Strip(Strip),
}

/// A sequence of faces crossed one after the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Strip {
    /// One more than portals: portal `i` leads from face `i` to face `i + 1`.
    pub(super) faces: Vec<FaceId>,
    pub(super) portals: Vec<Portal>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Portal {
    pub(super) edge: EdgeId,
    /// Where it is crossed, from 0 at its lower vertex to 1 at its higher one.
    pub(super) t: f64,
}

impl Portal {
    pub(super) fn point(self) -> SurfacePoint {
        SurfacePoint::Edge { edge: self.edge, t: self.t }
    }
}

impl StripPath {
    pub(super) fn length(&self, mesh: &IntrinsicMesh) -> f64 {
        let ends = self.nodes.iter().zip(self.nodes.iter().skip(1));
        let lengths = self.sections.iter().zip(ends).map(|(section, (a, b))| section.length(mesh, *a, *b));
        // The sum of no numbers would be -0.
        lengths.fold(0.0, |sum, length| sum + length)
    }
}

impl PathSection {
    pub(super) fn length(&self, mesh: &IntrinsicMesh, start: SurfacePoint, end: SurfacePoint) -> f64 {
        match self {
            Self::Link(length) => *length,
            Self::Strip(strip) => {
                let stops = strip.portals.iter().map(|portal| portal.point()).chain([end]);
                let mut here = start;
                let straight = |(stop, face): (SurfacePoint, &FaceId)| {
                    segment(mesh, *face, std::mem::replace(&mut here, stop), stop)
                };
                stops.zip(&strip.faces).map(straight).fold(0.0, |sum, length| sum + length)
            }
        }
    }
}

/// An edge laid out in the plane: its left and its right end.
pub(super) type Gate = [(VertexId, PlanePoint); 2];

/// A strip laid out in the plane.
#[derive(Debug, Clone)]
pub(super) struct Laid {
    pub(super) start: PlanePoint,
    pub(super) gates: Vec<Gate>,
    pub(super) end: PlanePoint,
}

impl Strip {
    pub(super) fn within(face: FaceId) -> Self {
        Self { faces: vec![face], portals: Vec::new() }
    }

    /// Removes detours: faces left through the edge they were entered by, and edges containing the start or end.
    pub(super) fn simplified(self, mesh: &IntrinsicMesh, start: SurfacePoint, end: SurfacePoint) -> Self {
        let mut faces = self.faces.into_iter();
        let mut simple = Self { faces: faces.next().into_iter().collect(), portals: Vec::new() };
        for (portal, face) in self.portals.into_iter().zip(faces) {
            if simple.portals.last().is_some_and(|last| last.edge == portal.edge) {
                simple.faces.pop();
                simple.portals.pop();
            }
            if simple.faces.last() != Some(&face) {
                simple.faces.push(face);
                simple.portals.push(portal);
            }
        }
        let on = |point, portal: &Portal| is_on(mesh, point, portal.edge);
        let past_start = simple.portals.iter().take_while(|portal| on(start, portal)).count();
        simple.portals.drain(..past_start);
        simple.faces.drain(..past_start);
        while simple.portals.last().is_some_and(|portal| on(end, portal)) {
            simple.portals.pop();
            simple.faces.pop();
        }
        simple
    }

    /// Lays the strip out in the plane, each face beyond the portal that leads into it.
    pub(super) fn lay_out(&self, mesh: &IntrinsicMesh, start: SurfacePoint, end: SurfacePoint) -> Laid {
        let topology = mesh.topology();
        let length = |a, b| topology.edge_between(a, b).map_or(0.0, |edge| mesh.length(edge));
        let Some(first) = self.portals.first() else {
            let flat = Flat::of_face(mesh, self.faces[0]);
            return Laid { start: flat.point(mesh, start), gates: Vec::new(), end: flat.point(mesh, end) };
        };
        let triangle = |face: FaceId, gate: &Gate, side: GateSide| {
            let [(left, at_left), (right, at_right)] = *gate;
            let vertices = topology.faces()[face.index()];
            let third = vertices.into_iter().find(|v| *v != left && *v != right).unwrap_or(left);
            let lengths = [length(left, right), length(left, third), length(right, third)];
            let at = beyond([at_left, at_right], lengths, side);
            (third, at, Flat { vertices: [left, right, third], at: [at_left, at_right, at] })
        };
        let [left, right] = topology.edges()[first.edge.index()];
        let mut gate = [(left, [0.0, 0.0]), (right, [mesh.length(first.edge), 0.0])];
        let start = triangle(self.faces[0], &gate, GateSide::Behind).2.point(mesh, start);
        let mut gates = vec![gate];
        for (face, portal) in self.faces[1..].iter().zip(&self.portals[1..]) {
            let (third, at, _) = triangle(*face, &gate, GateSide::Ahead);
            if topology.edges()[portal.edge.index()].contains(&gate[0].0) {
                gate[1] = (third, at);
            } else {
                gate[0] = (third, at);
            }
            gates.push(gate);
        }
        let last = self.faces[self.faces.len() - 1];
        Laid { start, gates, end: triangle(last, &gate, GateSide::Ahead).2.point(mesh, end) }
    }
}
