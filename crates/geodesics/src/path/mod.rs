//! Shortest paths along the surface.
//!
//! | module | what is in it |
//! |---|---|
//! | `plane` | faces laid out in the plane |
//! | `field` | distances and their sources, which paths lead to |
//! | `strip` | paths as nodes and the faces crossed between them, laid out one after the other |
//! | `edges` | paths along edges, as a fallback |
//! | `visibility` | the visible vertex over which the source is nearest |
//! | `funnel` | the shortest path through a strip of faces |
//! | `turn` | the angle of a path at a vertex, and the faces on its inner side |
//! | `straighten` | replaces bends by detours over their inner side until there are none |

mod edges;
mod field;
mod funnel;
mod plane;
mod straighten;
mod strip;
#[cfg(test)]
mod tests;
mod turn;
mod visibility;

use std::sync::OnceLock;

use base::{Budget, Observer};
use surface::IntrinsicMesh;

use crate::error::GeodesicError;
use crate::source::Source;
use edges::EdgeTree;
use field::PathField;
pub(crate) use plane::Flat;
use plane::faces_around;
use straighten::straighten;
use strip::{PathSection, StripPath};
use surface::SurfacePoint;
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

/// Limit of the vertices that a path is led over one after the other; two or three if the field is accurate.
const MAX_LEGS: usize = 64;

/// Limit of the bundles of rays followed for one path; some hundreds if the field is accurate.
const MAX_RAYS: usize = 50_000;

/// Finds shortest paths to the sources of a field of distances.
///
/// A first path goes straight from the target to the visible vertex over which the source is nearest, and so on from there. It is then
/// made locally shortest (Xin and Wang 2007, `xin2007`): straight through faces, bending only at vertices with at least 180 degrees
/// on either side. So the field only decides between paths on different sides of an obstacle, and its error does not enter the path.
///
/// * A path starts exactly at the source and ends exactly at the target. Its length is that of its points in order,
///   so it is at least the exact distance, and at most the distance along edges.
/// * With exact distances it is the shortest path.
/// * Any surface: edges with any number of faces, any orientation, boundaries, links, faces without area. It always
///   terminates: a path has a limited number of legs, and every step of straightening makes it shorter.
///   If the field leads nowhere, the path along edges is straightened.
///
/// Cost: in practice `O(k log k)` for a path that crosses `k` faces. If a path is longer than its distance in the
/// field, paths along edges are computed, once per tracer.
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
    /// Prepares paths to `sources`; `distances` are those of any solver on `mesh`, one per vertex, in mesh units. The
    /// budget of the observer is checked before and after each attempt at a path.
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
        Self {
            field: PathField::new(mesh, sources, distances),
            tree: OnceLock::new(),
            budget: observer.budget(),
        }
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
        let target = target.simplified(mesh);
        if faces_around(mesh, target).iter().any(|face| self.field.sources_within(*face).contains(&target)) {
            return Ok(GeodesicPath { points: vec![target], length: 0.0 });
        }
        let distance = |field: &[f64]| {
            around.reach().iter().map(|(v, d)| field[v.index()] + d).fold(f64::INFINITY, f64::min)
        };
        let known = distance(self.field.distances);
        if known == f64::INFINITY {
            return Err(GeodesicError::NoPath { point: target });
        }
        // Between vertices the field gives only an upper bound.
        let enough = if matches!(target, SurfacePoint::Vertex(_)) { known } else { 0.0 };
        self.budget.check()?;
        let mut rays = MAX_RAYS;
        let mut best = self.path_from(target, enough, MAX_LEGS, &mut rays).map(|path| straighten(mesh, path));
        self.budget.check()?;
        let length = |path: &Option<StripPath>| path.as_ref().map_or(f64::INFINITY, |path| path.length(mesh));
        if length(&best) > known && length(&best) > distance(&self.tree().distances) {
            let other = self.tree().path_from(mesh, target).map(|path| straighten(mesh, path));
            if length(&other) < length(&best) {
                best = other;
            }
        }
        best.map(|path| self.points_of(&path)).ok_or(GeodesicError::NoPath { point: target })
    }

    /// The path from `target` over the vertices that lead to a source, with at most these numbers of legs and rays. The first leg
    /// need not promise less than `enough`.
    fn path_from(
        &self,
        target: SurfacePoint,
        enough: f64,
        legs: usize,
        rays: &mut usize,
    ) -> Option<StripPath> {
        let field = &self.field;
        let mut link = None;
        if let SurfacePoint::Vertex(vertex) = target {
            if field.is_source(vertex) {
                return Some(StripPath { nodes: vec![target], sections: Vec::new() });
            }
            let totals =
                field.links(vertex).iter().map(|way| (way.length + field.distances[way.to.index()], way));
            link = totals.min_by(|a, b| a.0.total_cmp(&b.0));
        }
        let over_link = link.map_or(f64::INFINITY, |(total, _)| total);
        let (section, end) = match nearest_visible(field, target, over_link, enough, rays) {
            Some((end, strip)) => (PathSection::Strip(strip), end),
            None => link.map(|(_, way)| (PathSection::Link(way.length), SurfacePoint::Vertex(way.to)))?,
        };
        let mut path = StripPath { nodes: vec![target], sections: vec![section] };
        match end {
            SurfacePoint::Vertex(vertex) => {
                let rest =
                    self.path_from(end, field.distances[vertex.index()], legs.checked_sub(1)?, rays)?;
                path.nodes.extend(rest.nodes);
                path.sections.extend(rest.sections);
            }
            source => path.nodes.push(source),
        }
        Some(path)
    }

    /// The points of a path, from the source on.
    fn points_of(&self, path: &StripPath) -> GeodesicPath {
        let mut points = vec![path.nodes[0]];
        for (section, node) in path.sections.iter().zip(&path.nodes[1..]) {
            if let PathSection::Strip(strip) = section {
                points.extend(strip.portals.iter().map(|portal| portal.point()));
            }
            points.push(*node);
        }
        points.reverse();
        GeodesicPath { points, length: path.length(self.field.mesh) }
    }

    fn tree(&self) -> &EdgeTree {
        self.tree.get_or_init(|| EdgeTree::new(&self.field))
    }
}
