//! Paths along edges, as a fallback.

use surface::{FaceId, IntrinsicMesh, VertexId};

use super::field::PathField;
use super::plane::faces_around;
use super::strip::{PathSection, Strip, StripPath};
use crate::heap::VertexHeap;
use crate::source::Source;
use surface::SurfacePoint;

/// The shortest paths along edges from the sources to all vertices.
#[derive(Debug)]
pub(super) struct EdgeTree {
    pub(super) distances: Vec<f64>,
    /// The node and the section before every vertex on its path from the source.
    before: Vec<Option<(SurfacePoint, PathSection)>>,
}

impl EdgeTree {
    /// Cost: `O(p log p)`.
    pub(super) fn new(field: &PathField) -> Self {
        let n = field.mesh.n_vertices();
        let mut heap = VertexHeap::default();
        heap.reset(n);
        let mut before = vec![None; n];
        for source in field.sources {
            let point = source.point().simplified(field.mesh);
            for (vertex, distance) in source.reach() {
                if let Some(section) = within_face(field.mesh, point, *vertex)
                    && heap.relax(vertex.0, *distance)
                {
                    before[vertex.index()] = Some((point, section));
                }
            }
        }
        while let Some((distance, vertex)) = heap.pop() {
            let vertex = VertexId(vertex);
            let edges = edges_at(field.mesh, vertex)
                .map(|(next, length, face)| (next, length, PathSection::Strip(Strip::within(face))));
            let links = field.links(vertex).map(|(next, length)| (next, length, PathSection::Link(length)));
            for (next, length, section) in edges.chain(links) {
                if heap.relax(next.0, distance + length) {
                    before[next.index()] = Some((SurfacePoint::Vertex(vertex), section));
                }
            }
        }
        Self { distances: (0..n as u32).map(|v| heap.distance(v)).collect(), before }
    }

    /// The shortest path along edges from `target` to a source, if there is one.
    pub(super) fn path_from(&self, mesh: &IntrinsicMesh, target: SurfacePoint) -> Option<StripPath> {
        let around = Source::new(mesh, target).ok()?;
        let total = |(vertex, distance): &(VertexId, f64)| distance + self.distances[vertex.index()];
        let mut here = around.reach().iter().min_by(|a, b| total(a).total_cmp(&total(b)))?.0;
        let mut path = StripPath { nodes: vec![target], sections: Vec::new() };
        if target != SurfacePoint::Vertex(here) {
            path.sections.push(within_face(mesh, target, here)?);
            path.nodes.push(SurfacePoint::Vertex(here));
        }
        loop {
            let (before, section) = self.before[here.index()].clone()?;
            if before == SurfacePoint::Vertex(here) {
                return Some(path);
            }
            path.sections.push(section);
            path.nodes.push(before);
            match before {
                SurfacePoint::Vertex(vertex) => here = vertex,
                _ => return Some(path),
            }
        }
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

/// The section within a face from a point to a vertex of a face that holds it.
fn within_face(mesh: &IntrinsicMesh, point: SurfacePoint, vertex: VertexId) -> Option<PathSection> {
    let has_vertex = |face: &FaceId| mesh.topology().corner_at(*face, vertex).is_some();
    match faces_around(mesh, point).into_iter().find(has_vertex) {
        Some(face) => Some(PathSection::Strip(Strip::within(face))),
        // A vertex without faces.
        None => (point == SurfacePoint::Vertex(vertex)).then_some(PathSection::Link(0.0)),
    }
}
