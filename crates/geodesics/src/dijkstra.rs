//! Distances along edges.

use mesh::{IntrinsicMesh, VertexId};

use crate::graph::EdgeGraph;
use crate::heap::Front;
use crate::solver::{DistanceSolver, Pool};

/// Lengths of shortest paths along edges: an upper bound of the geodesic distance that does not
/// converge to it under refinement.
///
/// Cost `O(p log p)` per source.
#[derive(Debug)]
pub struct Dijkstra {
    graph: EdgeGraph,
    scratch: Pool<Front>,
}

impl Dijkstra {
    /// Prepares the edge graph of a surface.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh) -> Self {
        Self { graph: EdgeGraph::new(mesh), scratch: Pool::default() }
    }
}

impl DistanceSolver for Dijkstra {
    fn n_vertices(&self) -> usize {
        self.graph.n_vertices()
    }

    fn distances_into(&self, source: VertexId, out: &mut [f64]) {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        self.scratch.with(|front| {
            front.reset(out.len());
            front.relax(source.0, 0.0);
            while let Some((distance, vertex)) = front.pop() {
                out[vertex as usize] = distance;
                for &(target, length) in self.graph.neighbours(vertex) {
                    front.relax(target, distance + length);
                }
            }
            for (v, distance) in out.iter_mut().enumerate() {
                *distance = front.distance(v as u32);
            }
        });
    }
}
