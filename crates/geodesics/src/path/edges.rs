//! Paths along edges, as a fallback.

use surface::{EdgeGraph, EdgeId, FaceId, Frontier, IntrinsicMesh, VertexId};

use super::field::PathField;
use super::plane::faces_around;
use super::strip::{PathSection, Strip, StripPath};
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
        let (mesh, n) = (field.mesh, field.mesh.n_vertices());
        let (graph, mut front) = (EdgeGraph::of(mesh), Frontier::default());
        front.reset(n);
        let mut before = vec![None; n];
        for source in field.sources {
            let point = source.point().simplified(mesh);
            for (vertex, distance) in source.reach() {
                if let Some(section) = within_face(mesh, point, *vertex)
                    && front.relax(*vertex, *distance)
                {
                    before[vertex.index()] = Some((point, section));
                }
            }
        }
        graph.search(
            &mut front,
            f64::INFINITY,
            |_, _| true,
            |from, way| {
                let edge = ((way.number as usize) < mesh.topology().n_edges()).then_some(EdgeId(way.number));
                let section = edge.map_or(PathSection::Link(way.length), |edge| {
                    PathSection::Strip(Strip::within(mesh.topology().edge_corners(edge)[0].face()))
                });
                before[way.to.index()] = Some((SurfacePoint::Vertex(from), section));
            },
        );
        Self { distances: front.into_distances(), before }
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

/// The section within a face from a point to a vertex of a face that holds it.
fn within_face(mesh: &IntrinsicMesh, point: SurfacePoint, vertex: VertexId) -> Option<PathSection> {
    let has_vertex = |face: &FaceId| mesh.topology().corner_at(*face, vertex).is_some();
    match faces_around(mesh, point).into_iter().find(has_vertex) {
        Some(face) => Some(PathSection::Strip(Strip::within(face))),
        // A vertex without faces.
        None => (point == SurfacePoint::Vertex(vertex)).then_some(PathSection::Link(0.0)),
    }
}
