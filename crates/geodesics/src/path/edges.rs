//! Paths along edges, as a fallback.

use surface::{EdgeGraph, Frontier, IntrinsicMesh, SurfacePoint, VertexId};

use super::step::Step;
use crate::source::Source;

/// The shortest paths along edges from the sources to all vertices.
#[derive(Debug)]
pub(super) struct EdgeTree {
    pub(super) distances: Vec<f64>,
    /// The step from every vertex towards the source; to the vertex itself if it is one.
    towards: Vec<Option<Step>>,
}

impl EdgeTree {
    /// Cost: `O(p log p)`.
    pub(super) fn new(mesh: &IntrinsicMesh, sources: &[Source]) -> Self {
        let (graph, mut front) = (EdgeGraph::of(mesh), Frontier::default());
        front.reset(mesh.n_vertices());
        let mut towards = vec![None; mesh.n_vertices()];
        for source in sources {
            for (vertex, length) in source.reach() {
                if front.relax(*vertex, *length) {
                    towards[vertex.index()] = Some(Step { to: source.point(), length: *length });
                }
            }
        }
        graph.search(
            &mut front,
            f64::INFINITY,
            |_, _| true,
            |from, way| {
                let step = Step { to: SurfacePoint::Vertex(from), length: way.length };
                towards[way.to.index()] = Some(step);
            },
        );
        Self { distances: front.into_distances(), towards }
    }

    /// The shortest path along edges to a source, from a point with the given distances from vertices, if there is one.
    pub(super) fn path_from(&self, target: SurfacePoint, reach: &[(VertexId, f64)]) -> Option<Vec<Step>> {
        let total = |(vertex, length): &(VertexId, f64)| length + self.distances[vertex.index()];
        let (mut here, length) = *reach.iter().min_by(|a, b| total(a).total_cmp(&total(b)))?;
        let first = Step { to: SurfacePoint::Vertex(here), length };
        let mut steps: Vec<Step> = [first].into_iter().filter(|step| step.to != target).collect();
        loop {
            let step = self.towards[here.index()]?;
            if step.to == SurfacePoint::Vertex(here) {
                return Some(steps);
            }
            steps.push(step);
            match step.to {
                SurfacePoint::Vertex(vertex) => here = vertex,
                _ => return Some(steps),
            }
        }
    }
}
