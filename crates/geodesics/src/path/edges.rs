//! Ways along edges, where nothing better is known.

use surface::{CornerId, FaceId, IntrinsicMesh, VertexId};

use super::strip::{Section, Strip, Way};
use super::{PathTracer, on_the_least};
use crate::heap::VertexHeap;
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
        let mut heap = VertexHeap::default();
        heap.reset(n);
        let mut before = vec![None; n];
        for source in tracer.sources {
            let point = on_the_least(tracer.mesh, source.point());
            for (vertex, distance) in source.reach() {
                if let Some(section) = within_face(tracer.mesh, point, *vertex)
                    && heap.relax(vertex.0, *distance)
                {
                    before[vertex.index()] = Some((Before::Source(point), section));
                }
            }
        }
        while let Some((distance, vertex)) = heap.pop() {
            let vertex = VertexId(vertex);
            let edges = edges_at(tracer.mesh, vertex)
                .map(|(next, length, face)| (next, length, Section::Strip(Strip::within(face))));
            let links = tracer.links(vertex).map(|(next, length)| (next, length, Section::Link(length)));
            for (next, length, section) in edges.chain(links) {
                if heap.relax(next.0, distance + length) {
                    before[next.index()] = Some((Before::Vertex(vertex), section));
                }
            }
        }
        Self { distances: (0..n as u32).map(|v| heap.distance(v)).collect(), before }
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
