//! Exact distances on polyhedral surfaces.
//!
//! | module | what is in it |
//! |---|---|
//! | `prepared` | all that is prepared once: the surface renumbered for locality, its faces, and the corners around its vertices |
//! | `window` | an interval of an edge and the unfolded source of its paths; windows and paths across a face |
//! | `envelope` | the windows at one edge reduced to those that may carry a shortest path |
//! | `front` | labels of vertices, their order, and waiting windows |
//! | `propagation` | the main loop |
//! | `pseudo_sources` | new windows, from sources and from vertices where paths bend |
//! | `bearing`, `tangent_plane`, `log_map` | the directions in which paths leave the source, and the map that they make |

mod bearing;
mod envelope;
mod front;
mod log_map;
mod prepared;
mod propagation;
mod pseudo_sources;
mod tangent_plane;
mod window;

#[cfg(test)]
mod tests;

use std::sync::Arc;

use base::{Budget, Exceeded, Observer};
use surface::IntrinsicMesh;

pub use log_map::log_map;

use crate::solver::{DistanceSolver, Pool, within};
use crate::source::Source;
use prepared::PreparedSurface;
use propagation::ExactScratch;

/// Exact distances on the surface: rounding is the only error.
///
/// A shortest path is straight through the faces it crosses, laid out in the plane, and bends only at saddle vertices
/// (more than 360 degrees) and at boundary vertices with more than 180 degrees. A **window** is an interval of an
/// edge to whose points straight paths lead from one such vertex, the pseudo-source, or from the source, through one
/// sequence of faces. Windows are propagated across face after face. Where several overlap, the nearest counts.
///
/// | paper | here | meaning |
/// |---|---|---|
/// | `(b0, b1)` | `start..end` | the interval of the edge, which lies on the x-axis |
/// | `(d0, d1)` | `(x, -depth)` | the pseudo-source laid out in the plane of the edge, instead of two distances |
/// | `sigma` | `offset` | distance of the pseudo-source from the source |
/// | `d(v)` | label | shortest known path to a vertex |
///
/// The distance at the point `t` of the edge is `offset + sqrt((t - x)^2 + depth^2)`.
///
/// * **Order.** Windows wait at an edge until the nearer of its ends is the nearest vertex of the front, and are then
///   propagated across the next face together; most edges are crossed once. Any other order is correct, but slower.
/// * **Pruning.** Of the windows that wait on one side of an edge, only the lower envelope is propagated, cut where a
///   path through an end of the edge is shorter. Of several windows with a path to the apex of the next face, only
///   the nearest continues on both sides of it. A pseudo-source sends windows only into directions at least 180
///   degrees away from where its own path comes from. Windows of one source that meet behind a vertex without
///   curvature are joined.
/// * **Any mesh.** At an edge with more than two faces, windows enter all the others. Paths may bend in any direction
///   where faces do not form a single fan around a vertex, at the ends of links and of edges without length.
///   Orientation does not matter. Of faces with the same vertices only one is used. A face without area is inflated
///   to `1e-12` of its longest edge. Successive faces that have a side without length may hide a path; repair drops
///   such faces.
/// * **Guarantees.** Every distance is the length of a path, up to rounding; symmetric, and at most that along edges.
///   Infinite exactly where no edge or link leads. More windows than any known surface needs are an error
///   ([`Exceeded::Steps`]). Those that wait at once keep to the memory of the budget divided by the number of threads, or to 1 GiB.
/// * **Cost.** At worst `O(p^2)`, in practice near `O(p^1.2)`, linear on flat parts; about 400 bytes per vertex.
///
/// Mitchell, Mount and Papadimitriou 1987 (`mitchell1987`). Splitting windows at one apex only is from Xin and Wang
/// 2009 (`xin2009`), the order by vertices from Qin et al. 2016 (`qin2016`). **Deviations:** sources are kept
/// unfolded, so that roots are needed only where two windows are compared; windows are compared with their neighbors
/// on the same side of an edge only.
///
/// ```
/// use canonform_geodesics::{DistanceSolver, Exact};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // From a corner of a unit cube to the opposite one, straight across two unfolded sides.
/// let solver = Exact::new(&shapes::cube(0).intrinsic(), &());
/// assert!((solver.distances(VertexId(0))?[7] - 5f64.sqrt()).abs() < 1e-12);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Exact {
    surface: Arc<PreparedSurface>,
    scratch: Arc<Pool<ExactScratch>>,
    budget: Budget,
}

impl Exact {
    /// Prepares a surface. The solver keeps to the budget of the observer.
    pub fn new(mesh: &IntrinsicMesh, observer: &dyn Observer) -> Self {
        let surface = Arc::new(PreparedSurface::new(mesh));
        Self { surface, scratch: Arc::default(), budget: observer.budget() }
    }

    /// The same solver with the budget of another observer.
    pub fn observed_by(&self, observer: &dyn Observer) -> Self {
        Self { budget: observer.budget(), ..self.clone() }
    }
}

impl DistanceSolver for Exact {
    fn n_vertices(&self) -> usize {
        self.surface.n_vertices()
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        let unit = self.surface.faces.unit;
        self.scratch.with(|scratch| {
            let front = propagation::run(&self.surface, scratch, max_distance, (sources, &()), &self.budget)?;
            for (distance, vertex) in out.iter_mut().zip(&self.surface.new_vertices) {
                *distance = within(front.distance(*vertex) * unit, max_distance);
            }
            Ok(())
        })
    }
}
