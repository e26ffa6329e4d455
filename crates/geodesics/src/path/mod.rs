//! Shortest paths along the surface.
//!
//! | module | what is in it |
//! |---|---|
//! | `field` | distances and their sources, which paths lead to |
//! | `visibility` | the visible vertex over which the source is nearest |
//! | `edges` | paths along edges, as a fallback |
//! | `step` | a straight step of a path |

mod edges;
mod field;
mod step;
#[cfg(test)]
mod tests;
mod visibility;

use std::sync::OnceLock;

use base::{Budget, Observer};
use surface::{IntrinsicMesh, Link, SurfacePoint};

use crate::error::GeodesicError;
use crate::source::Source;
use edges::EdgeTree;
use field::PathField;
use step::Step;
use visibility::nearest_visible;

/// A path along the surface, straight in every face it crosses.
#[derive(Debug, Clone, PartialEq)]
pub struct GeodesicPath {
    /// Its points from the source to the target, where it crosses edges and passes vertices. Consecutive points are
    /// in one face, on one edge, or at the ends of a link.
    pub points: Vec<SurfacePoint>,
    /// Its length, in mesh units.
    pub length: f64,
}

/// Limit of the bundles of rays followed for one path; some hundreds if the distances are exact.
const MAX_RAYS: usize = 50_000;

/// Share of its length by which rounding may make a path longer than its distance.
const ROUNDING: f64 = 1e-13;

/// Finds shortest paths to the sources of exact distances.
///
/// A path goes straight from the target to the visible vertex over which the source is nearest, and so on from there.
///
/// * A path starts exactly at the source and ends exactly at the target. Its length is that of its points in order,
///   so it is at least the exact distance, and at most the distance along edges.
/// * With the distances of [`Exact`](crate::Exact) it is the shortest path. Errors of other distances enter the path.
/// * Any surface: edges with any number of faces, any orientation, boundaries, links, faces without area. It always
///   terminates, since every straight line leads to a smaller distance. If distances lead nowhere, the path is one along edges.
///
/// Cost: in practice `O(k log k)` for a path that crosses `k` faces. If a path is longer than its distance, paths along edges
/// are computed, once per tracer.
///
/// ```
/// use canonform_geodesics::{DistanceSolver, Exact, PathTracer, Source, SurfacePoint};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// // From a corner of a unit cube to the opposite one, across the middle of an edge.
/// let cube = shapes::cube(0).intrinsic();
/// let sources = [Source::vertex(VertexId(0))];
/// let distances = Exact::new(&cube, &()).distances(VertexId(0))?;
/// let path = PathTracer::new(&cube, &sources, &distances, &()).path_to(SurfacePoint::Vertex(VertexId(7)))?;
/// assert!((path.length - 5f64.sqrt()).abs() < 1e-12);
/// assert!(matches!(path.points[1], SurfacePoint::Edge { t, .. } if (t - 0.5).abs() < 1e-12));
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct PathTracer<'a> {
    field: PathField<'a>,
    tree: OnceLock<EdgeTree>,
    budget: Budget,
}

impl<'a> PathTracer<'a> {
    /// Prepares paths to `sources`; `distances` are the exact ones from them on `mesh`, one per vertex, in mesh units, perhaps with a
    /// limit. The budget of the observer is checked before and after each path.
    ///
    /// # Panics
    /// If there is not one distance per vertex.
    pub fn new(
        mesh: &'a IntrinsicMesh,
        sources: &'a [Source],
        distances: &'a [f64],
        observer: &dyn Observer,
    ) -> Self {
        assert_eq!(distances.len(), mesh.n_vertices(), "one distance per vertex");
        let (field, tree) = (PathField { mesh, sources, distances }, OnceLock::new());
        Self { field, tree, budget: observer.budget() }
    }

    /// The shortest path from the nearest source to `target`.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`] and [`GeodesicError::BadPoint`] if the target is not on the surface;
    /// [`GeodesicError::NoPath`] if its distance is infinite, or no edge or link leads there;
    /// [`GeodesicError::Exceeded`].
    pub fn path_to(&self, target: SurfacePoint) -> Result<GeodesicPath, GeodesicError> {
        let mesh = self.field.mesh;
        let around = Source::new(mesh, target)?;
        let target = around.point();
        if self.field.is_source(target) {
            return Ok(GeodesicPath { points: vec![target], length: 0.0 });
        }
        let distance = |field: &[f64]| {
            around.reach().iter().map(|(v, d)| field[v.index()] + d).fold(f64::INFINITY, f64::min)
        };
        let known = distance(self.field.distances);
        if known == f64::INFINITY {
            return Err(GeodesicError::NoPath { point: target });
        }
        self.budget.check()?;
        let length = |steps: &[Step]| steps.iter().fold(0.0, |sum, step| sum + step.length);
        let mut steps = self.straight_from(target);
        if steps.as_ref().is_none_or(|steps| length(steps) > known * (1.0 + ROUNDING)) {
            let tree = self.tree.get_or_init(|| EdgeTree::new(mesh, self.field.sources));
            if steps.as_ref().is_none_or(|steps| length(steps) > distance(&tree.distances)) {
                steps = tree.path_from(target, around.reach());
            }
        }
        self.budget.check()?;
        let steps = steps.ok_or(GeodesicError::NoPath { point: target })?;
        let length = length(&steps);
        let mut points: Vec<_> = [target].into_iter().chain(steps.into_iter().map(|step| step.to)).collect();
        points.reverse();
        Ok(GeodesicPath { points, length })
    }

    /// The steps from `target` over the vertices that lead to a source, if the distances do.
    fn straight_from(&self, target: SurfacePoint) -> Option<Vec<Step>> {
        let field = &self.field;
        let (mut here, mut steps, mut rays) = (target, Vec::new(), MAX_RAYS);
        loop {
            // Between vertices the distances give only an upper bound.
            let (mut below, mut known, mut enough, mut link) = (f64::INFINITY, f64::INFINITY, 0.0, None);
            if let SurfacePoint::Vertex(vertex) = here {
                if field.is_source(here) {
                    return Some(steps);
                }
                below = field.distances[vertex.index()];
                enough = below;
                for Link { ends: [a, b], length } in
                    field.mesh.links().iter().filter(|l| l.ends.contains(&vertex))
                {
                    let to = if *a == vertex { *b } else { *a };
                    let to_source = field.distances[to.index()];
                    if to_source < below && length + to_source < known {
                        known = length + to_source;
                        link = Some(Step { to: SurfacePoint::Vertex(to), length: *length });
                    }
                }
            }
            match nearest_visible(field, here, [below, known, enough], &mut rays) {
                Some(straight) => steps.extend(straight),
                None => steps.push(link?),
            }
            here = steps.last()?.to;
            if !matches!(here, SurfacePoint::Vertex(_)) {
                return Some(steps);
            }
        }
    }
}
