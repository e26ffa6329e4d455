//! Distances in hops.

use std::collections::VecDeque;

use base::{Budget, Exceeded, Observer};
use surface::{EdgeGraph, IntrinsicMesh, VertexId};

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
/// assert_eq!(BreadthFirst::new(&mesh, &()).distances(VertexId(0))?, [0.0, hop, hop, hop]);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct BreadthFirst {
    graph: EdgeGraph,
    hop: f64,
    scratch: Pool<VecDeque<VertexId>>,
    budget: Budget,
}

impl BreadthFirst {
    /// Prepares a surface. The solver keeps to the budget of the observer.
    pub fn new(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Self {
        let (graph, hop) = (EdgeGraph::of(mesh), mesh.mean_edge_length());
        Self { graph, hop, scratch: Pool::default(), budget: observer.budget() }
    }
}

impl DistanceSolver for BreadthFirst {
    fn n_vertices(&self) -> usize {
        self.graph.n_vertices()
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        out.fill(f64::INFINITY);
        self.scratch.with(|queue| {
            queue.clear();
            let mut meter = self.budget.meter();
            // A point on an edge or a face counts as its nearest vertex.
            for source in sources {
                if let Some((vertex, _)) = source.reach().iter().min_by(|a, b| a.1.total_cmp(&b.1)) {
                    out[vertex.index()] = 0.0;
                    queue.push_back(*vertex);
                }
            }
            while let Some(vertex) = queue.pop_front() {
                let hops = out[vertex.index()] + 1.0;
                let neighbors = self.graph.ways(vertex);
                meter.count(1 + neighbors.len())?;
                for way in neighbors {
                    if out[way.to.index()] > hops {
                        out[way.to.index()] = hops;
                        queue.push_back(way.to);
                    }
                }
            }
            self.budget.check()
        })?;
        out.iter_mut().for_each(|distance| *distance = within(*distance * self.hop, max_distance));
        Ok(())
    }
}
