//! Ways along edges, where nothing better is known.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use surface::{CornerId, FaceId, IntrinsicMesh, VertexId};

use super::strip::{Section, Strip, Way};
use super::{PathTracer, on_the_least};
use crate::{Source, SurfacePoint};

/// The shortest ways along edges from the sources to all vertices.
#[derive(Debug)]
pub(super) struct EdgeTree {
    /// How far every vertex is.
    pub(super) distances: Vec<f64>,
    /// What comes before every vertex on the way from the source.
    before: Vec<Option<(Before, Section)>>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Before {
    Vertex(VertexId),
    Source(SurfacePoint),
}

impl EdgeTree {
    /// Cost: `O(p log p)`.
    pub(super) fn new(tracer: &PathTracer) -> Self {
        let n = tracer.mesh.n_vertices();
        let mut tree = Self { distances: vec![f64::INFINITY; n], before: vec![None; n] };
        // Distances are not negative, so that their bits are in their order.
        let mut queue = BinaryHeap::new();
        for source in tracer.sources {
            let point = on_the_least(tracer.mesh, source.point());
            for (vertex, distance) in source.reach() {
                if let Some(section) = within_face(tracer.mesh, point, *vertex)
                    && *distance < tree.distances[vertex.index()]
                {
                    tree.distances[vertex.index()] = *distance;
                    tree.before[vertex.index()] = Some((Before::Source(point), section));
                    queue.push(Reverse((distance.to_bits(), *vertex)));
                }
            }
        }
        while let Some(Reverse((bits, vertex))) = queue.pop() {
            let distance = f64::from_bits(bits);
            if distance > tree.distances[vertex.index()] {
                continue;
            }
            let mut reach = |next: VertexId, length: f64, section: Section| {
                if distance + length < tree.distances[next.index()] {
                    tree.distances[next.index()] = distance + length;
                    tree.before[next.index()] = Some((Before::Vertex(vertex), section));
                    queue.push(Reverse(((distance + length).to_bits(), next)));
                }
            };
            for (next, length, face) in edges_at(tracer.mesh, vertex) {
                reach(next, length, Section::Strip(Strip::within(face)));
            }
            for (next, length) in tracer.links(vertex) {
                reach(next, length, Section::Link(length));
            }
        }
        tree
    }

    /// The shortest way along edges from `target` to a source; `None` if there is none.
    pub(super) fn way_from(&self, mesh: &IntrinsicMesh, target: SurfacePoint) -> Option<Way> {
        let around = Source::new(mesh, target).ok()?;
        let total = |(vertex, distance): &(VertexId, f64)| distance + self.distances[vertex.index()];
        let mut here = around.reach().iter().min_by(|a, b| total(a).total_cmp(&total(b)))?.0;
        let mut way = Way { nodes: vec![target], sections: Vec::new() };
        if target != SurfacePoint::Vertex(here) {
            way.sections.push(within_face(mesh, target, here)?);
            way.nodes.push(SurfacePoint::Vertex(here));
        }
        loop {
            let (before, section) = self.before[here.index()].clone()?;
            if before == Before::Source(SurfacePoint::Vertex(here)) {
                return Some(way);
            }
            way.sections.push(section);
            match before {
                Before::Vertex(vertex) => {
                    way.nodes.push(SurfacePoint::Vertex(vertex));
                    here = vertex;
                }
                Before::Source(point) => {
                    way.nodes.push(point);
                    return Some(way);
                }
            }
        }
    }
}

/// The faces that hold a point.
pub(super) fn faces_around(mesh: &IntrinsicMesh, point: SurfacePoint) -> Vec<FaceId> {
    let faces = |corners: &[CornerId]| corners.iter().map(|corner| corner.face()).collect();
    match point {
        SurfacePoint::Vertex(vertex) => faces(mesh.topology().vertex_corners(vertex)),
        SurfacePoint::Edge { edge, .. } => faces(mesh.topology().edge_corners(edge)),
        SurfacePoint::Face { face, .. } => vec![face],
    }
}

/// The edges at a vertex, once for each face on them: the other end, the length, the face.
fn edges_at(mesh: &IntrinsicMesh, vertex: VertexId) -> impl Iterator<Item = (VertexId, f64, FaceId)> {
    let topology = mesh.topology();
    topology.vertex_corners(vertex).iter().flat_map(move |corner| {
        [(corner.next(), corner.prev()), (corner.prev(), corner.next())]
            .map(|(third, end)| (topology.corner_vertex(end), mesh.opposite_length(third), corner.face()))
    })
}

/// The way within a face from a point to a vertex of a face that holds it.
fn within_face(mesh: &IntrinsicMesh, point: SurfacePoint, vertex: VertexId) -> Option<Section> {
    let holds = |face: &FaceId| mesh.topology().faces()[face.index()].contains(&vertex);
    let face = faces_around(mesh, point).into_iter().find(holds);
    match face {
        Some(face) => Some(Section::Strip(Strip::within(face))),
        // A vertex without faces.
        None => (point == SurfacePoint::Vertex(vertex)).then_some(Section::Link(0.0)),
    }
}
