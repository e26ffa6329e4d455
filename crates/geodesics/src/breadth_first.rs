//! Distances in hops.

use std::collections::VecDeque;

use surface::IntrinsicMesh;

use crate::graph::EdgeGraph;
use crate::solver::{DistanceSolver, Pool, within};
use crate::source::Source;

/// The least number of edges and links between vertices, times the mean edge length: the baseline of Civril et al.
/// 2007 (`civril2007`), called BFS in the paper. Cost: `O(p)` per source.
///
/// ```
/// use canonform_geodesics::{BreadthFirst, DistanceSolver};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// let mesh = shapes::tetrahedron(0).intrinsic();
/// let hop = mesh.mean_edge_length();
/// assert_eq!(BreadthFirst::new(&mesh).distances(VertexId(0)), [0.0, hop, hop, hop]);
/// ```
#[derive(Debug)]
pub struct BreadthFirst {
    graph: EdgeGraph,
    hop: f64,
    scratch: Pool<VecDeque<u32>>,
}

impl BreadthFirst {
    /// Prepares a surface.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh) -> Self {
        Self { graph: EdgeGraph::new(mesh), hop: mesh.mean_edge_length(), scratch: Pool::default() }
    }
}

impl DistanceSolver for BreadthFirst {
    fn n_vertices(&self) -> usize {
        self.graph.n_vertices()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        out.fill(f64::INFINITY);
        self.scratch.with(|queue| {
            queue.clear();
            // A point on an edge or a face counts as its nearest vertex.
            for source in sources {
                if let Some((vertex, _)) = source.reach().iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
                    out[vertex.index()] = 0.0;
                    queue.push_back(vertex.0);
                }
            }
            while let Some(vertex) = queue.pop_front() {
                let hops = out[vertex as usize] + 1.0;
                for &(target, _) in self.graph.neighbours(vertex) {
                    if out[target as usize] > hops {
                        out[target as usize] = hops;
                        queue.push_back(target);
                    }
                }
            }
        });
        out.iter_mut().for_each(|distance| *distance = within(*distance * self.hop, max_distance));
    }
}
