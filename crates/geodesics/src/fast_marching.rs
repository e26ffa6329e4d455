//! Fast marching on triangles.

use mesh::IntrinsicMesh;

use crate::Source;
use crate::heap::Front;
use crate::solver::{DistanceSolver, Pool, within};
use crate::update::Corner;
use crate::wedges::{CornerReport, ObtuseTreatment, Wedges};

/// The local solver of a marching front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Update {
    /// The front in a triangle comes from one point: exact in the plane, first order elsewhere with a
    /// small constant. Novotni and Klein 2002.
    #[default]
    PointSource,
    /// The front in a triangle is a straight line. Kimmel and Sethian 1998, as in the paper.
    Planar,
}

/// Options of [`FastMarching`].
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FastMarchingOptions {
    /// The local solver. Default: [`Update::PointSource`].
    pub update: Update,
    /// How a corner wider than 90 degrees is treated. Default: [`ObtuseTreatment::Unfold`].
    pub obtuse: ObtuseTreatment,
}

/// A correction smaller than this share of the distance is rounding, and not worth another visit.
const SIGNIFICANT: f64 = 1.0 - 1e-14;

/// Approximate geodesic distances by a front that passes every vertex about once.
///
/// * A vertex `C` takes the smallest of the edge candidates `T(A) + |AC|` and, for each corner at
///   `C` whose base `AB` the front has passed, the solution of the local solver in the plane of
///   the triangle.
/// * Distances are 1-Lipschitz along edges, at most Dijkstra's, never NaN, and infinite exactly on
///   the components that do not hold the source.
/// * Exact in the ring around the source; elsewhere the error is of first order in the edge length.
/// * Corners are independent of each other, so edges with any number of faces and any mixture of
///   orientations are nothing special; only unfolding stops at them.
///
/// Cost `O(p)` to set up, `O(p log p)` per source.
///
/// [`kimmel1998`], [`novotni2002`] in `REFERENCES.bib`.
///
/// **Deviation** from Kimmel and Sethian: a vertex that the front has passed is corrected when a
/// corner that completes later gives it a smaller distance (in an acute triangle the far end of the
/// base may be reached after the apex).
///
/// [`kimmel1998`]: https://doi.org/10.1073/pnas.95.15.8431
/// [`novotni2002`]: https://cg.cs.uni-bonn.de
#[derive(Debug)]
pub struct FastMarching {
    wedges: Wedges,
    report: CornerReport,
    update: Update,
    scratch: Pool<Front>,
}

impl FastMarching {
    /// Prepares a surface for marching.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh, options: FastMarchingOptions) -> Self {
        let (wedges, report) = Wedges::new(mesh, options.obtuse);
        Self { wedges, report, update: options.update, scratch: Pool::default() }
    }

    /// How many corners are obtuse, and how many of them could not be split.
    #[must_use]
    pub fn corner_report(&self) -> CornerReport {
        self.report
    }

    fn march(&self, front: &mut Front, max_distance: f64, solve: impl Fn(Corner, f64, f64) -> f64) {
        // How far the front has been. A corrected vertex is behind it: the other end of a base then counts
        // as passed although it lies farther away, or the result would depend on the order of the wedges.
        let mut passed = 0.0f64;
        while let Some((distance, vertex)) = front.pop() {
            passed = passed.max(distance);
            if distance > max_distance {
                break;
            }
            for wedge in self.wedges.of(vertex) {
                let known = front.distance(wedge.target);
                let at_other = front.distance(wedge.other);
                if known <= distance && !(at_other < known && wedge.corner.may_complete_late()) {
                    continue;
                }
                let mut reached = distance + wedge.edge;
                if at_other <= passed {
                    reached = reached.min(solve(wedge.corner, distance, at_other));
                }
                if reached < known * SIGNIFICANT {
                    front.relax(wedge.target, reached);
                }
            }
        }
    }
}

impl DistanceSolver for FastMarching {
    fn n_vertices(&self) -> usize {
        self.wedges.order.len()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        self.scratch.with(|front| {
            front.reset(out.len());
            for (vertex, distance) in sources.iter().flat_map(Source::reach) {
                front.relax(self.wedges.rank[vertex.index()], *distance);
            }
            match self.update {
                Update::PointSource => {
                    self.march(front, max_distance, |corner, a, b| corner.point_source(a, b));
                }
                Update::Planar => self.march(front, max_distance, |corner, a, b| corner.planar(a, b)),
            }
            for (internal, v) in self.wedges.order.iter().enumerate() {
                out[*v as usize] = within(front.distance(internal as u32), max_distance);
            }
        });
    }
}
