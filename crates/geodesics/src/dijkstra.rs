//! Distances along edges.

use base::{Budget, Exceeded, Observer};
use surface::{IntrinsicMesh, Rows};

use crate::graph::edge_graph;
use crate::heap::VertexHeap;
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
    graph: Rows<(u32, f64)>,
    scratch: Pool<VertexHeap>,
    budget: Budget,
}

impl Dijkstra {
    /// Prepares a surface. The solver keeps to the budget of the observer.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Self {
        Self { graph: edge_graph(mesh), scratch: Pool::default(), budget: observer.budget() }
    }
}

impl DistanceSolver for Dijkstra {
    fn n_vertices(&self) -> usize {
        self.graph.n_rows()
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        self.scratch.with(|heap| {
            heap.reset(out.len());
            let mut meter = self.budget.meter();
            for (vertex, distance) in sources.iter().flat_map(Source::reach) {
                heap.relax(vertex.0, *distance);
            }
            while let Some((distance, vertex)) = heap.pop() {
                if distance > max_distance {
                    break;
                }
                let neighbours = self.graph.row(vertex as usize);
                meter.count(1 + neighbours.len())?;
                for &(target, length) in neighbours {
                    heap.relax(target, distance + length);
                }
            }
            for (v, distance) in (0..).zip(out) {
                *distance = within(heap.distance(v), max_distance);
            }
            self.budget.check()
        })
    }
}
