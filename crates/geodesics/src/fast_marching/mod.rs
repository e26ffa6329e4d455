//! Fast marching on triangles.
//!
//! | module | holds |
//! |---|---|
//! | `triangulation`, `flips` | the triangles that a front runs over, and how they become round |
//! | `unfold`, `splits` | the other way with obtuse corners |
//! | `spokes`, `chains` | what a vertex does when the front leaves it, laid out for speed |
//! | `update` | the local solvers |
//! | `march` | the front on its way, round by round |
//! | `bands` | which vertices are in a round |
//! | `departures`, `sieve` | what these may lower, along edges and through triangles |
//! | `crossings` | the triangles among that, solved side by side |

mod bands;
mod chains;
mod crossings;
mod departures;
mod flips;
mod march;
mod sieve;
mod splits;
mod spokes;
mod triangulation;
mod unfold;
mod update;

use surface::{IntrinsicMesh, VertexId};

use crate::Source;
use crate::graph::EdgeGraph;
use crate::solver::{DistanceSolver, Pool, PrunedSolver, within};
use chains::Part;
use march::March;
use spokes::Spokes;
use triangulation::Triangulation;
pub(crate) use update::Sector;

/// The local solver of a marching front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Update {
    /// The front in a triangle comes from one point: exact in the plane, first order elsewhere with a
    /// small constant. Novotni and Klein 2002.
    #[default]
    PointSource,
    /// The front in a triangle is a straight line. Kimmel and Sethian 1998, as in the paper.
    Planar,
}

/// How a fast-marching solver treats corners wider than 90 degrees, at which a front may arrive before
/// it has passed both ends of their base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ObtuseTreatment {
    /// Flip edges inside the surface until few are left (the intrinsic Delaunay triangulation), and
    /// correct vertices behind the front.
    #[default]
    Flip,
    /// Unfold the surface behind the corner and split it, as Kimmel and Sethian do.
    Unfold,
    /// Treat them like acute ones: faster to set up, less accurate.
    Ignore,
}

/// Options of [`FastMarching`].
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct FastMarchingOptions {
    /// The local solver. Default: [`Update::PointSource`].
    pub update: Update,
    /// How a corner wider than 90 degrees is treated. Default: [`ObtuseTreatment::Flip`].
    pub obtuse: ObtuseTreatment,
}

/// Facts about the preparation of a surface for marching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CornerReport {
    /// Number of corners.
    pub corners: usize,
    /// Corners wider than 90 degrees.
    pub obtuse: usize,
    /// How many edges were flipped; zero without [`ObtuseTreatment::Flip`].
    pub flips: usize,
    /// Obtuse corners that are treated like acute ones: left by the flips, next to boundaries and
    /// non-manifold edges where unfolding stops, or all.
    pub left: usize,
}

/// Approximate geodesic distances by a front that passes every vertex about once.
///
/// The front goes on in narrow bands. What the vertices of a band may lower is found for all of them before
/// any is lowered, and the triangles among that are solved side by side.
///
/// * A vertex `C` takes the smallest of the edge candidates `T(A) + |AC|` and, for each triangle at
///   `C` whose side `AB` the front has passed, the solution of the local solver.
/// * Distances are 1-Lipschitz along edges, at most Dijkstra's, never NaN, and infinite exactly on
///   the components that do not hold the source.
/// * Exact in the plane to rounding; elsewhere the error is of first order in the edge length.
/// * Triangles are independent of each other, so edges with any number of faces and any mixture of
///   orientations are nothing special; only flips and unfolding stop at them.
///
/// Cost `O(p)` to set up; per source `O(p)` where neighbouring edges are of similar length.
///
/// [`kimmel1998`], [`novotni2002`], [`dial1969`] and [`meyer2003`] (bands), [`kim2001`] (a band at a time) in
/// `REFERENCES.bib`.
///
/// **Deviations** from Kimmel and Sethian:
/// * Edges are flipped inside the surface instead of unfolding obtuse corners.
/// * Vertices of one band have no order among each other. A vertex that the front has passed is corrected
///   when it gets a smaller distance, from its own band or by a triangle that completes later (in an acute
///   triangle the far end of the base may be reached after the apex).
/// * Each vertex remembers at which distance the way to it last bent around a vertex (more than 360
///   degrees, or a boundary), as exact algorithms do. The front in a triangle is a circle around that
///   bend and not around the source: with circles that are too large, distances came out too long. Where
///   the ways to the two ends of a base bent at different distances, one between them is taken.
///
/// [`kimmel1998`]: https://doi.org/10.1073/pnas.95.15.8431
/// [`novotni2002`]: https://cg.cs.uni-bonn.de
/// [`dial1969`]: https://doi.org/10.1145/363269.363610
/// [`meyer2003`]: https://doi.org/10.1016/S0196-6774(03)00076-2
/// [`kim2001`]: https://doi.org/10.1137/S1064827500367130
#[derive(Debug)]
pub struct FastMarching {
    spokes: Spokes,
    report: CornerReport,
    update: Update,
    scratch: Pool<March>,
}

impl FastMarching {
    /// Prepares a surface for marching.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh, options: FastMarchingOptions) -> Self {
        let ((triangulation, extras, report), order) =
            rayon::join(|| prepared(mesh, options.obtuse), || EdgeGraph::new(mesh).breadth_first_order());
        let spokes = Spokes::new(order, &triangulation, &extras, mesh.mean_edge_length());
        Self { spokes, report, update: options.update, scratch: Pool::default() }
    }

    fn run(&self, march: &mut March, sources: &[Source], stops: impl Fn(u32, f64) -> bool) {
        march.reset(&self.spokes);
        for (vertex, distance) in sources.iter().flat_map(Source::reach) {
            march.start(self.spokes.rank[vertex.index()], *distance);
        }
        match self.update {
            Update::PointSource => march.run(&self.spokes, stops, Sector::point_source),
            Update::Planar => march.run(&self.spokes, stops, Sector::planar),
        }
    }

    /// What was done about obtuse corners.
    #[must_use]
    pub fn corner_report(&self) -> CornerReport {
        self.report
    }
}

/// The triangles to march over, parts of vertices beside them, and what was done about obtuse corners.
fn prepared(
    mesh: &IntrinsicMesh,
    obtuse: ObtuseTreatment,
) -> (Triangulation, Vec<(u32, Part)>, CornerReport) {
    let plain = Triangulation::new(mesh);
    let wide = plain.obtuse_corners();
    let report = CornerReport { corners: 3 * plain.faces.len(), obtuse: wide, flips: 0, left: wide };
    match obtuse {
        ObtuseTreatment::Flip => {
            let (flipped, flips) = flips::flipped(mesh, plain);
            let left = flipped.obtuse_corners();
            (flipped, Vec::new(), CornerReport { flips, left, ..report })
        }
        ObtuseTreatment::Unfold => {
            let (splits, left) = splits::splits(mesh);
            (plain, splits, CornerReport { left, ..report })
        }
        ObtuseTreatment::Ignore => (plain, Vec::new(), report),
    }
}

/// Beyond the vertices that a new source is nearest to, a pruned front goes on for this many times the
/// longest way from the vertex it is at: distances near the border come out as without pruning.
const BORDER: f64 = 2.0;

impl DistanceSolver for FastMarching {
    fn n_vertices(&self) -> usize {
        self.spokes.order.len()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        let stops = |_, distance| distance > max_distance;
        self.scratch.with(|march| {
            self.run(march, sources, stops);
            for (internal, v) in self.spokes.order.iter().enumerate() {
                out[*v as usize] = within(march.distance(internal as u32), max_distance);
            }
        });
    }

    fn pruned(&self) -> Option<&dyn PrunedSolver> {
        Some(self)
    }
}

impl PrunedSolver for FastMarching {
    fn lower(&self, source: VertexId, nearest: &mut [f64]) {
        assert_eq!(nearest.len(), self.n_vertices(), "one distance per vertex");
        self.scratch.with(|march| {
            self.run(march, &[Source::vertex(source)], |vertex, distance| {
                let excess = distance - nearest[self.spokes.order[vertex as usize] as usize];
                excess > 0.0 && excess > BORDER * self.spokes.longest_of(vertex)
            });
            for (internal, v) in self.spokes.order.iter().enumerate() {
                let known = &mut nearest[*v as usize];
                *known = known.min(march.distance(internal as u32));
            }
        });
    }
}
