//! Fast marching on triangles.
//!
//! | module | what is in it |
//! |---|---|
//! | `triangles` | the triangles and their neighbors, laid out for speed |
//! | `window` | what a triangle sees of the source |
//! | `crossing` | windows that leave triangles, and the distances they give, in lanes |
//! | `queue` | which triangles are in a round |
//! | `front` | the loop over rounds, and the distances of the vertices |
//! | `planar` | the other way to march: from vertex to vertex |
//! | `unfold` | one of two treatments of obtuse corners; the other is `surface::Triangulation::flip_to_delaunay` |
//!
//! # One run, step by step
//!
//! Every triangle has a label: a *window*, which says where in its plane the source lies, and the distance of its
//! centroid. Where a path bends, at a *saddle vertex* with more than 360 degrees around it or at a boundary vertex with
//! more than 180, the vertex becomes the *virtual source*.
//!
//! 1. **Start.** The triangles around the source see it directly.
//! 2. **Pop.** The queue holds triangles in buckets, each a third of a mean edge wide. A round takes all triangles out of
//!    the first bucket that has any. Within the bucket they are not sorted.
//! 3. **Leave.** The window of each leaves through the two sides where it did not enter. Eight triangles are solved
//!    together, in lanes, by the same instructions without branches: the distance of the corner opposite the entry, which
//!    lowers that vertex after the round, and behind each of the two sides a window and the distance of the centroid there.
//!    A window that tells an end of its entry to be nearer than it is known to be has rays that left the surface, at a hole or
//!    beside a saddle vertex. Its source moves to where it agrees with both ends.
//! 4. **Improve.** Only when all triangles of a round are solved, each triangle behind them takes the window through
//!    which its centroid is nearest, so that the order of the triangles changes nothing. It enters the bucket of its new
//!    distance; if that is the current one, another round follows. Between one triangle in twenty and one in ten is
//!    visited twice.
//! 5. **Relax edges.** Where two vertices differ by more than the length of the edge between them, the farther is
//!    lowered, and so on; likewise along edges that were flipped away, and links.
//! 6. **Start again** from the ends of links, from vertices where parts touch, and next to triangles that no window has
//!    reached, if that makes a triangle nearer.
//!
//! Meshes may have triangles of very different sizes, so the width of the buckets adapts.

mod crossing;
mod front;
mod planar;
mod queue;
mod triangles;
mod unfold;
mod window;

use std::borrow::Cow;
use std::cell::Cell;

use base::{Budget, Exceeded, Observer};
use surface::{IntrinsicMesh, Loops, Rows, Triangulation, VertexId};

use crate::order::patches_of;
use crate::solver::{DistanceSolver, Pool, within};
use crate::source::Source;
use front::TriangleFront;
use planar::PlanarFront;
use triangles::Triangles;
use unfold::{HalfCorner, split_obtuse_corners};

/// The local solver of fast marching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum Update {
    /// Triangles hand on where the source lies in their plane
    ///
    /// Every triangle knows where the source, or the vertex where the path bent last, lies in its plane, and hands
    /// that on to its neighbors. After Trettner, Bommes and Kobbelt 2021 (`trettner2021`), with limits to what a
    /// triangle sees. Exact in the plane, and its error falls when flat triangles are subdivided. It needs no treatment
    /// of obtuse corners: [`ObtuseTreatment::Unfold`] leaves them as they are.
    #[default]
    VirtualSource,
    /// The front in a triangle is a straight line (Kimmel and Sethian)
    ///
    /// `kimmel1998`, as in the paper: slower and less accurate.
    Planar,
}

/// The treatment of corners wider than 90 degrees, which a front may reach before both ends of their base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
pub enum ObtuseTreatment {
    /// Flip interior edges until few are left
    ///
    /// The result is the intrinsic Delaunay triangulation.
    #[default]
    Flip,
    /// Unfold the surface across the angle and split it (Kimmel and Sethian)
    Unfold,
    /// Treat them like any other
    ///
    /// Faster to set up, less accurate.
    Ignore,
}

/// Options of [`FastMarching`].
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct FastMarchingOptions {
    /// The local solver. Default: [`Update::VirtualSource`].
    pub update: Update,
    /// The treatment of corners wider than 90 degrees. Default: [`ObtuseTreatment::Flip`].
    pub obtuse: ObtuseTreatment,
}

/// Approximate geodesic distances by a front that visits every triangle about once (Kimmel and Sethian 1998; Trettner,
/// Bommes and Kobbelt 2021).
///
/// * Distances are 1-Lipschitz along edges, at most those along edges ([`Dijkstra`](crate::Dijkstra)), never NaN, and
///   infinite exactly where no edge or link leads.
/// * Exact to rounding on flat sheets where no path bends. Elsewhere the mean error is 0.1 % on meshes of ten thousand vertices, also
///   behind holes: there distances converge when triangles get smaller, and are too short by less than 1 % everywhere.
/// * With a limit, distances just below it may be too long: triangles beyond the limit are not solved.
/// * Triangles are independent of each other, so edges may have any number of faces of any orientation. Flips and
///   unfolding stop at such edges.
///
/// Cost: `O(p)` to set up; per source `O(p)` if neighboring edges are of similar length.
///
/// **Deviations** from Kimmel and Sethian:
/// * Virtual sources ([`Update::VirtualSource`]) instead of the planar update.
/// * Edges are flipped inside the surface instead of unfolding obtuse corners. Removed edges are still relaxed.
/// * The queue is a bucket queue ([`dial1969`], [`meyer2003`]): all triangles within a third of a mean edge length are
///   handled at once ([`kim2001`]), without order. A triangle that is nearer through another window is visited again.
///
/// **Deviations** from Trettner, Bommes and Kobbelt: paths bend at saddle and boundary vertices only, windows end at
/// such vertices, and distances are 64-bit numbers.
///
/// The keys are those of `REFERENCES.bib`, as is [`kimmel1998`].
///
/// ```
/// use canonform_geodesics::{DistanceSolver, FastMarching, FastMarchingOptions};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // A sheet of 9 x 5 vertices, one unit apart: distances in a plane are exact.
/// let sheet = shapes::grid(9, 5, 1.0);
/// let solver = FastMarching::new(sheet.intrinsic(), FastMarchingOptions::default(), &());
/// let distances = solver.distances(VertexId(0))?;
/// assert!((distances[44] - 8f64.hypot(4.0)).abs() < 1e-12);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
///
/// [`kimmel1998`]: https://doi.org/10.1073/pnas.95.15.8431
/// [`dial1969`]: https://doi.org/10.1145/363269.363610
/// [`meyer2003`]: https://doi.org/10.1016/S0196-6774(03)00076-2
/// [`kim2001`]: https://doi.org/10.1137/S1064827500367130
#[derive(Debug)]
pub struct FastMarching {
    /// The unit of all lengths in the layout, in mesh units. Other than 1 only for very short or very long edges.
    unit: f64,
    triangles: Triangles,
    /// Of the planar update, the halves of obtuse corners, by the vertices of their bases.
    halves: Option<Rows<HalfCorner>>,
    fronts: Pool<TriangleFront>,
    planar_fronts: Pool<PlanarFront>,
    budget: Budget,
}

impl FastMarching {
    /// Prepares a surface. The solver keeps to the budget of the observer. The memory of a surface that is given away is
    /// free before that of the solver is needed.
    pub fn new<'a>(
        mesh: impl Into<Cow<'a, IntrinsicMesh>>,
        options: FastMarchingOptions,
        observer: &dyn Observer,
    ) -> Self {
        let owned = mesh.into();
        // Otherwise products of lengths would vanish or overflow.
        let unit = owned.unit();
        let owned = if unit == 1.0 { owned } else { Cow::Owned(owned.in_units_of(unit)) };
        let mesh = owned.as_ref();
        let carries_sources = options.update == Update::VirtualSource;
        let (prepared, order) = rayon::join(
            || {
                let mut triangulation = Triangulation::new(mesh);
                let (segments, halves) = match options.obtuse {
                    ObtuseTreatment::Flip => (triangulation.flip_to_delaunay(Loops::Forbidden), Vec::new()),
                    ObtuseTreatment::Unfold if !carries_sources => split_obtuse_corners(mesh),
                    ObtuseTreatment::Unfold | ObtuseTreatment::Ignore => Default::default(),
                };
                (triangulation, segments, halves)
            },
            || patches_of(mesh),
        );
        let (triangulation, segments, halves) = prepared;
        let (mean, links) = (mesh.mean_edge_length(), mesh.links().to_vec());
        drop(owned);
        let triangles = Triangles::new(order, &triangulation, &links, &segments, mean);
        let at = |v| triangles.number(v);
        let halves = halves.iter().map(|(v, HalfCorner { base, apex, third })| {
            let half = HalfCorner { base: (at(base.0), base.1), apex: (at(apex.0), apex.1), third: *third };
            (at(*v).index(), half)
        });
        let halves = (!carries_sources).then(|| Rows::collect(triangles.order.len(), halves));
        let (fronts, planar_fronts) = (Pool::default(), Pool::default());
        Self { unit, triangles, halves, fronts, planar_fronts, budget: observer.budget() }
    }

    /// Gives the distances from the nearest of `sources` to `found`, by mesh vertex. The front `stops` near a vertex at a
    /// distance, given the length of the longest edge there.
    fn run(
        &self,
        sources: &[Source],
        stops: impl Fn(u32, f64, &dyn Fn() -> f64) -> bool,
        mut found: impl FnMut(u32, f64),
    ) -> Result<(), Exceeded> {
        let unit = self.unit;
        let scaled: Vec<Source>;
        let sources = if unit == 1.0 {
            sources
        } else {
            scaled = sources.iter().map(|source| source.in_units_of(unit)).collect();
            &scaled
        };
        let triangles = &self.triangles;
        let numbers = (0..).map(VertexId).zip(&triangles.order);
        match &self.halves {
            None => self.fronts.with(|front| {
                front.run(triangles, sources, &self.budget, |number, distance| {
                    let triangle = triangles.at(number);
                    let longest = || unit * triangle.lengths.into_iter().fold(0.0, f64::max);
                    let stops_at =
                        |v: &VertexId| stops(triangles.order[v.index()], unit * distance, &longest);
                    triangle.vertices().iter().all(stops_at)
                })?;
                numbers.for_each(|(internal, v)| found(*v, unit * front.distance(internal)));
                Ok(())
            }),
            Some(halves) => self.planar_fronts.with(|front| {
                front.run(triangles, halves, sources, &self.budget, |vertex, distance| {
                    let lengths = || triangles.ways_from(vertex).map(|(_, length)| length);
                    let longest = || unit * lengths().fold(0.0, f64::max);
                    stops(triangles.order[vertex.index()], unit * distance, &longest)
                })?;
                numbers.for_each(|(internal, v)| found(*v, unit * front.distance(internal)));
                Ok(())
            }),
        }
    }
}

/// A pruned front stops this many times the longest edge at a vertex beyond the vertices nearest to the new source,
/// so that distances near the border are the same as without pruning: a safety margin. Farthest points are checked
/// against full distances; [`SpreadSamples`](crate::SpreadSamples) are not.
const BORDER: f64 = 2.0;

impl DistanceSolver for FastMarching {
    fn n_vertices(&self) -> usize {
        self.triangles.order.len()
    }

    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(out.len(), self.n_vertices(), "one distance per vertex");
        let stops = |_, distance, longest: &dyn Fn() -> f64| {
            distance > max_distance && distance > max_distance + longest()
        };
        self.run(sources, stops, |v, distance| out[v as usize] = within(distance, max_distance))
    }

    fn prunes(&self) -> bool {
        true
    }

    fn lower(&self, source: VertexId, nearest: &mut [f64]) -> Result<(), Exceeded> {
        assert_eq!(nearest.len(), self.n_vertices(), "one distance per vertex");
        let nearest = Cell::from_mut(nearest).as_slice_of_cells();
        let stops = |v: u32, distance, longest: &dyn Fn() -> f64| {
            let excess = distance - nearest[v as usize].get();
            excess > 0.0 && excess > BORDER * longest()
        };
        self.run(&[Source::vertex(source)], stops, |v, distance| {
            let known = &nearest[v as usize];
            known.set(known.get().min(distance));
        })
    }
}
