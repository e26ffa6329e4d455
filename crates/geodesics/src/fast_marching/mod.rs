//! Fast marching on triangles.
//!
//! | module | what is in it |
//! |---|---|
//! | `update` | the local solvers: one triangle, two known distances, one new distance |
//! | `one_ring` | the neighbours of every vertex and the triangles between them, laid out for speed |
//! | `unfold` | one of two treatments of obtuse corners; the other is `surface::Triangulation::flip_to_delaunay` |
//! | `relaxation` | what one round relaxes, and how triangles are solved in lanes |
//! | `buckets` | the queue: which vertices are in a round |
//! | `front` | the loop over rounds |
//! | `virtual_source` | the other way to march: from triangle to triangle |
//!
//! # One round, step by step
//!
//! Every vertex has a label: its tentative distance, and the distance of its *pseudo-source*, the vertex where the
//! path to it last bent (zero if the path is straight). Paths can bend at a *saddle vertex*, with more than 360
//! degrees around it, and at a boundary vertex with more than 180 degrees.
//!
//! 1. **Pop.** The queue holds vertices in buckets, each a twentieth of a mean edge wide. A round takes all vertices
//!    out of the first bucket that has any. Vertices at distances below this bucket are *finalized*; the others are
//!    the *frontier*. Vertices within the bucket are not sorted.
//! 2. **List.** For each vertex `A` of the round, its one-ring is read once, front to back. Each neighbour `B` gives
//!    an *edge relaxation*, `T(A) + |AB|`. Each triangle `ABC` gives a *triangle update* of the farther of `B` and
//!    `C` from the two others, if the nearer is finalized. An item is listed only if it may lower a label. Whether it
//!    may is computed without branches, and the lists are filled by stream compaction: the item is always written,
//!    and the length grows by zero or one. A processor would mispredict such branches again and again, each time at
//!    the end of a chain of square roots.
//! 3. **Solve.** The triangles listed are solved four at a time, in lanes, by the same instructions. The distances at
//!    both ends of the base are taken relative to their pseudo-source (or to a distance between two different ones),
//!    and the local solver finds the distance at the third vertex as if that were a point in the plane.
//! 4. **Apply.** Only now are labels lowered. All items of the round were computed from the same labels, so neither
//!    the order of the vertices nor that of the items changes the result. A lowered vertex enters the bucket of its
//!    new distance. If that is the current bucket, another round follows.
//! 5. **Correct.** A finalized vertex may be lowered again. This happens if it was in the same bucket as the vertex
//!    that lowers it, or if a triangle *completes late*: even in an acute triangle, the front may reach the apex
//!    before the far end of the base. Far from the pseudo-source, only nearly right and obtuse corners can complete
//!    late; flags in the one-ring tell which. A corrected vertex is visited again, so its neighbours are corrected in
//!    turn. Between one vertex in fifty and one in ten is corrected.
//!
//! Meshes may have triangles of very different sizes, so the width of the buckets adapts.

mod buckets;
mod front;
mod one_ring;
mod relaxation;
mod unfold;
mod update;
mod virtual_source;

use std::borrow::Cow;
use std::cell::Cell;

use base::{Budget, Exceeded, Observer};
use surface::{IntrinsicMesh, Loops, Triangulation, VertexId};

use crate::graph::patches_of;
use crate::solver::{DistanceSolver, Pool, PrunedSolver, within};
use crate::source::Source;
use front::VertexFront;
use one_ring::OneRings;
use unfold::split_obtuse_corners;
pub(crate) use update::Stencil;
use virtual_source::{TriangleFront, Triangles};

/// The local solver of fast marching.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Update {
    /// Every triangle knows where the source, or the vertex where the path bent last, lies in its plane, and hands
    /// that on to its neighbours. After Trettner, Bommes and Kobbelt 2021 (`trettner2021`), with limits to what a
    /// triangle sees. The most accurate, and its error falls when flat triangles are subdivided; it takes twice as
    /// long. It needs no treatment of obtuse corners: [`ObtuseTreatment::Unfold`] leaves them as they are.
    VirtualSource,
    /// The front in a triangle comes from one point: exact in the plane, elsewhere of first order with a small
    /// constant. Novotni and Klein 2002 (`novotni2002`).
    #[default]
    PointSource,
    /// The front in a triangle is a straight line. Kimmel and Sethian 1998 (`kimmel1998`), as in the paper.
    Planar,
}

/// The treatment of corners wider than 90 degrees, which a front may reach before both ends of their base.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ObtuseTreatment {
    /// Flip edges inside the surface until few such corners are left (the intrinsic Delaunay triangulation).
    #[default]
    Flip,
    /// Unfold the surface behind the corner and split it, as Kimmel and Sethian do.
    Unfold,
    /// Nothing: faster to set up, less accurate.
    Ignore,
}

/// Options of [`FastMarching`].
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub struct FastMarchingOptions {
    /// The local solver. Default: [`Update::PointSource`].
    pub update: Update,
    /// The treatment of corners wider than 90 degrees. Default: [`ObtuseTreatment::Flip`].
    pub obtuse: ObtuseTreatment,
}

/// Approximate geodesic distances by a front that visits every vertex about once (Kimmel and Sethian 1998).
///
/// * A vertex `C` gets the smallest of `T(A) + |AC|` over its edges, and of the solution of the local solver over its
///   triangles `ABC` whose side `AB` is finalized.
/// * Distances are 1-Lipschitz along edges, at most those along edges ([`Dijkstra`](crate::Dijkstra)), never NaN, and
///   infinite exactly where no edge or link leads.
/// * Exact in the plane to rounding. Elsewhere the error is of first order in the edge length: 0.3 % on average on
///   meshes of thousands of vertices.
/// * With a limit, distances just below it may be too long: triangles with a vertex beyond the limit are not solved.
/// * Triangles are independent of each other, so edges may have any number of faces of any orientation. Flips and
///   unfolding stop at such edges.
///
/// Cost: `O(p)` to set up; per source `O(p)` if neighbouring edges are of similar length.
///
/// **Deviations** from Kimmel and Sethian:
/// * Edges are flipped inside the surface instead of unfolding obtuse corners. Removed edges are still relaxed.
/// * The queue is a bucket queue ([`dial1969`], [`meyer2003`]): all vertices within a twentieth of a mean edge length
///   are handled at once ([`kim2001`]), without order. Finalized vertices are corrected if their distance falls.
/// * As in exact algorithms, each vertex stores the distance of its pseudo-source, where the path to it last bent at
///   a saddle or boundary vertex. The front in a triangle is a circle around the pseudo-source; one around the source
///   would make distances too long.
///
/// The keys are those of `REFERENCES.bib`, as are [`kimmel1998`] and [`novotni2002`].
///
/// ```
/// use canonform_geodesics::{DistanceSolver, FastMarching, FastMarchingOptions};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // A sheet of 9 x 5 vertices, one unit apart: distances in a plane are exact.
/// let sheet = shapes::grid(9, 5, 1.0);
/// let solver = FastMarching::new(&sheet.intrinsic(), FastMarchingOptions::default(), &());
/// let distances = solver.distances(VertexId(0))?;
/// assert!((distances[44] - 8f64.hypot(4.0)).abs() < 1e-12);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
///
/// [`kimmel1998`]: https://doi.org/10.1073/pnas.95.15.8431
/// [`novotni2002`]: https://cg.cs.uni-bonn.de
/// [`dial1969`]: https://doi.org/10.1145/363269.363610
/// [`meyer2003`]: https://doi.org/10.1016/S0196-6774(03)00076-2
/// [`kim2001`]: https://doi.org/10.1137/S1064827500367130
#[derive(Debug)]
pub struct FastMarching {
    /// The unit of all lengths in the layout, in mesh units. Other than 1 only for very short or very long edges.
    unit: f64,
    layout: MarchLayout,
    budget: Budget,
}

/// The surface as the local solver needs it, and memory for fronts.
#[derive(Debug)]
enum MarchLayout {
    Triangles(Triangles, Pool<TriangleFront>),
    OneRings(OneRings, Update, Pool<VertexFront>),
}

/// Up to this many vertices, a mesh that is handed over is kept until one-rings are laid out, which is then faster.
const LEAN: usize = 1 << 19;

impl FastMarching {
    /// Prepares a surface. The solver keeps to the budget of the observer.
    #[must_use]
    pub fn new(mesh: &IntrinsicMesh, options: FastMarchingOptions, observer: &dyn Observer) -> Self {
        Self::of(Cow::Borrowed(mesh), options, observer)
    }

    /// As [`new`](Self::new), with a surface whose memory is free before that of the solver is needed.
    #[must_use]
    pub fn from_owned(mesh: IntrinsicMesh, options: FastMarchingOptions, observer: &dyn Observer) -> Self {
        Self::of(Cow::Owned(mesh), options, observer)
    }

    fn of(owned: Cow<'_, IntrinsicMesh>, options: FastMarchingOptions, observer: &dyn Observer) -> Self {
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
        // The connectivity only makes the layout faster.
        let kept = match owned {
            Cow::Owned(mesh) if mesh.n_vertices() > LEAN => {
                drop(mesh);
                None
            }
            mesh => Some(mesh),
        };
        let layout = if carries_sources {
            let triangles = Triangles::new(order, &triangulation, &links, &segments, mean);
            MarchLayout::Triangles(triangles, Pool::default())
        } else {
            let topology = kept.as_deref().map(IntrinsicMesh::topology);
            let links = [links, segments].concat();
            let rings = OneRings::new(order, topology, &triangulation, &links, &halves, mean);
            MarchLayout::OneRings(rings, options.update, Pool::default())
        };
        Self { unit, layout, budget: observer.budget() }
    }

    /// Gives the distances from the nearest of `sources` to `found`, by mesh vertex.
    fn run(
        &self,
        sources: &[Source],
        stops: impl Stops,
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
        match &self.layout {
            MarchLayout::Triangles(triangles, scratch) => scratch.with(|front| {
                front.run(triangles, sources, &self.budget, |number, distance| {
                    let longest = || unit * triangles.longest_of(number);
                    triangles.mesh_vertices(number).into_iter().all(|v| stops(v, unit * distance, &longest))
                })?;
                (0..)
                    .zip(&triangles.order)
                    .for_each(|(internal, v)| found(*v, unit * front.distance(internal)));
                Ok(())
            }),
            MarchLayout::OneRings(rings, update, scratch) => scratch.with(|front| {
                front.reset(rings);
                for (vertex, distance) in sources.iter().flat_map(Source::reach) {
                    front.start(rings.rank[vertex.index()], *distance);
                }
                let stops = |vertex, distance| {
                    let longest = || unit * rings.longest_at(vertex);
                    stops(rings.order[vertex as usize], unit * distance, &longest)
                };
                match update {
                    Update::Planar => front.run(rings, &self.budget, stops, Stencil::planar),
                    _ => front.run(rings, &self.budget, stops, Stencil::point_source),
                }?;
                (0..).zip(&rings.order).for_each(|(internal, v)| found(*v, unit * front.distance(internal)));
                Ok(())
            }),
        }
    }
}

/// Whether a front stops near a mesh vertex at a distance, given the length of the longest edge there.
trait Stops: Fn(u32, f64, &dyn Fn() -> f64) -> bool {}

impl<F: Fn(u32, f64, &dyn Fn() -> f64) -> bool> Stops for F {}

/// A pruned front stops this many times the longest edge at a vertex beyond the vertices nearest to the new source,
/// so that distances near the border are the same as without pruning: a safety margin. Farthest points are checked
/// against full distances; [`SpreadSamples`](crate::SpreadSamples) are not.
const BORDER: f64 = 2.0;

impl DistanceSolver for FastMarching {
    fn n_vertices(&self) -> usize {
        match &self.layout {
            MarchLayout::Triangles(triangles, _) => triangles.order.len(),
            MarchLayout::OneRings(rings, ..) => rings.order.len(),
        }
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

    fn pruned(&self) -> Option<&dyn PrunedSolver> {
        Some(self)
    }
}

impl PrunedSolver for FastMarching {
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
