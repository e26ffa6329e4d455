//! Distances along edges.

use base::{Budget, Exceeded, Observer};
use surface::{EdgeGraph, Frontier, IntrinsicMesh, Link, VertexId};

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
    /// The length of an edge in mesh units, if edges are counted.
    hop: Option<f64>,
    scratch: Pool<Frontier>,
    budget: Budget,
}

impl Dijkstra {
    /// Prepares a surface. The solver keeps to the budget of the observer.
    pub fn new(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Self {
        let graph = EdgeGraph::of(mesh);
        Self { graph, hop: None, scratch: Pool::default(), budget: observer.budget() }
    }

    /// The least number of edges and links between vertices, times the mean edge length: the baseline of Civril et al. 2007
    /// (`civril2007`), called BFS in the paper. A point on an edge or a face counts as its nearest vertex.
    ///
    /// ```
    /// use canonform_geodesics::{Dijkstra, DistanceSolver};
    /// use mesh::shapes;
    /// use surface::VertexId;
    ///
    /// let mesh = shapes::tetrahedron(0).intrinsic();
    /// let hop = mesh.mean_edge_length();
    /// assert_eq!(Dijkstra::of_hops(&mesh, &()).distances(VertexId(0))?, [0.0, hop, hop, hop]);
    /// # Ok::<(), canonform_geodesics::GeodesicError>(())
    /// ```
    pub fn of_hops(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Self {
        let ends = mesh.topology().edges().iter().copied().chain(mesh.links().iter().map(|link| link.ends));
        let graph = EdgeGraph::new(mesh.n_vertices(), ends.map(|ends| Link { ends, length: 1.0 }));
        let (hop, budget) = (Some(mesh.mean_edge_length()), observer.budget());
        Self { graph, hop, scratch: Pool::default(), budget }
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
        let (unit, radius) = self.hop.map_or((1.0, max_distance), |hop| (hop, f64::INFINITY));
        self.scratch.with(|front| {
            front.reset(out.len());
            for source in sources {
                let nearest = source.reach().iter().min_by(|a, b| a.1.total_cmp(&b.1));
                match (self.hop, nearest) {
                    (Some(_), Some((vertex, _))) => _ = front.relax(*vertex, 0.0),
                    _ => source.reach().iter().for_each(|(vertex, d)| _ = front.relax(*vertex, *d)),
                }
            }
            let (mut meter, mut counted) = (self.budget.meter(), Ok(()));
            let visit = |v: VertexId, _| {
                counted = meter.count(1 + self.graph.ways(v).len());
                counted.is_ok()
            };
            self.graph.search(front, radius, visit, |_, _| ());
            counted?;
            for (v, distance) in (0..).map(VertexId).zip(out) {
                *distance = within(front.distance(v) * unit, max_distance);
            }
            self.budget.check()
        })
    }
}
