//! Distances along edges.

use base::{Budget, Exceeded, Observer};
use surface::{EdgeGraph, Frontier, IntrinsicMesh, VertexId};

use crate::solver::{DistanceSolver, Pool, within};
use crate::source::Source;

/// Lengths of shortest paths along edges and links (Dijkstra 1959): an upper bound of the geodesic distance that does
/// not converge to it under refinement. Cost: `O(p log p)` per source.
///
/// ```
/// use canonform_geodesics::{Dijkstra, DistanceSolver};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // On a unit cube whose sides have one diagonal each, two corners are at most two edges apart.
/// let along_edges = Dijkstra::new(&shapes::cube(0).intrinsic(), &()).distances(VertexId(0))?;
/// assert!(along_edges.iter().all(|d| *d <= 1.0 + 2f64.sqrt()));
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct Dijkstra {
    graph: EdgeGraph,
    scratch: Pool<Frontier>,
    budget: Budget,
}

impl Dijkstra {
    /// Prepares a surface. The solver keeps to the budget of the observer.
    pub fn new(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Self {
        Self { graph: EdgeGraph::of(mesh), scratch: Pool::default(), budget: observer.budget() }
    }
}

impl DistanceSolver for Dijkstra {
    fn n_vertices(&self) -> usize {
        self.graph.n_vertices()
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        self.scratch.with(|front| {
            front.reset(out.len());
            for (vertex, distance) in sources.iter().flat_map(Source::reach) {
                front.relax(*vertex, *distance);
            }
            let (mut meter, mut counted) = (self.budget.meter(), Ok(()));
            let visit = |v: VertexId, _| {
                counted = meter.count(1 + self.graph.ways(v).len());
                counted.is_ok()
            };
            self.graph.search(front, max_distance, visit, |_, _| ());
            counted?;
            for (v, distance) in (0..).map(VertexId).zip(out) {
                *distance = within(front.distance(v), max_distance);
            }
            self.budget.check()
        })
    }
}
