//! Shortest paths along the surface.
//!
//! | module | what it does |
//! |---|---|
//! | `plane` | faces laid out in the plane |
//! | `strip` | ways: nodes, and the faces crossed between them, laid out one after the other |
//! | `descent` | a first way from a point to the source, down the field of distances |
//! | `edges` | ways along edges, where nothing better is known |
//! | `sight` | the vertex in sight over which the source is nearest |
//! | `funnel` | the shortest way through a strip of faces |
//! | `turn` | how far a way turns at a vertex, and the faces on the inner side |
//! | `straighten` | leads ways through the inner side of their bends until there is none |

mod descent;
mod edges;
mod funnel;
mod plane;
mod sight;
mod straighten;
mod strip;
#[cfg(test)]
mod tests;
mod turn;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::OnceLock;

use surface::{CornerId, FaceId, IntrinsicMesh, VertexId};

use crate::{GeodesicError, Source, SurfacePoint};
use descent::descend;
use edges::{EdgeTree, faces_around};
use sight::look;
use straighten::straighten;
use strip::{Section, Way};

/// A path along the surface, straight in every face it crosses.
#[derive(Debug, Clone, PartialEq)]
pub struct GeodesicPath {
    /// Its points from the source to the target: where it crosses edges and passes vertices. Two in a
    /// row lie in one face, on one edge, or at the ends of a link.
    pub points: Vec<SurfacePoint>,
    /// Its length, in mesh units.
    pub length: f64,
}

/// Vertices over which a way may be led one after the other; where the field is good, two or three.
const MAX_LEGS: usize = 64;

/// Rays that may be followed for one path; where the field is good, some hundreds.
const MAX_RAYS: usize = 50_000;

/// Share by which a way may be longer than the field says for rounding alone.
const ROUNDING: f64 = 1e-11;

/// Finds shortest paths to the sources of a field of distances.
///
/// A first way goes from the target down the field to the nearest source and is then made locally
/// shortest (Xin and Wang 2007, `xin2007`): straight through faces, bending only at vertices where
/// either side is at least half a turn. So the field only decides between ways around mountains, and
/// its error does not enter the path.
///
/// * A path starts and ends exactly at the source and at the target. Its length is that of the list
///   of its points, so it is at least the exact distance, and at most the distance along edges.
/// * With exact distances it is the shortest path but for rare targets near a ridge of the field.
/// * Any surface: edges with any number of faces, any orientation, boundaries, links, faces without
///   area. It always ends: a way passes no vertex and crosses no edge twice, and straightening makes
///   it shorter in every step. Where the field leads nowhere, the way along edges is taken.
///
/// Cost: `O(k log k)` for a path that crosses `k` faces, in practice. When a path is longer than the field
/// says, the ways along edges are found once for the tracer.
#[derive(Debug)]
pub struct PathTracer<'a> {
    mesh: &'a IntrinsicMesh,
    sources: &'a [Source],
    distances: &'a [f64],
    /// Both directions of every link: from, to, length; sorted.
    links: Vec<(VertexId, VertexId, f64)>,
    /// The sources that are vertices, and the others by the faces that hold them.
    at_vertices: BTreeSet<VertexId>,
    in_faces: BTreeMap<FaceId, Vec<SurfacePoint>>,
    tree: OnceLock<EdgeTree>,
}

impl<'a> PathTracer<'a> {
    /// Prepares paths to `sources`, from which `distances` were measured on `mesh` by any solver, an
    /// entry per vertex in mesh units.
    ///
    /// # Panics
    /// When there is not one distance per vertex.
    #[must_use]
    pub fn new(mesh: &'a IntrinsicMesh, sources: &'a [Source], distances: &'a [f64]) -> Self {
        assert_eq!(distances.len(), mesh.n_vertices(), "one distance per vertex");
        let both =
            |link: &surface::Link| [(0, 1), (1, 0)].map(|(i, j)| (link.ends[i], link.ends[j], link.length));
        let mut links: Vec<_> = mesh.links().iter().flat_map(both).collect();
        links.sort_unstable_by(|p, q| (p.0, p.1).cmp(&(q.0, q.1)).then(p.2.total_cmp(&q.2)));
        let mut at_vertices = BTreeSet::new();
        let mut in_faces: BTreeMap<FaceId, Vec<SurfacePoint>> = BTreeMap::new();
        for point in sources.iter().map(|source| on_the_least(mesh, source.point())) {
            if let SurfacePoint::Vertex(vertex) = point {
                at_vertices.insert(vertex);
                continue;
            }
            for face in faces_around(mesh, point) {
                in_faces.entry(face).or_default().push(point);
            }
        }
        Self { mesh, sources, distances, links, at_vertices, in_faces, tree: OnceLock::new() }
    }

    /// The shortest path from the nearest source to `target`.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`] and [`GeodesicError::BadPoint`] when the target is not on the
    /// surface; [`GeodesicError::NoWay`] when the field is infinite there, or nothing leads there.
    pub fn path_to(&self, target: SurfacePoint) -> Result<GeodesicPath, GeodesicError> {
        let around = Source::new(self.mesh, target)?;
        let target = on_the_least(self.mesh, target);
        if faces_around(self.mesh, target).iter().any(|face| self.sources_within(*face).contains(&target)) {
            return Ok(GeodesicPath { points: vec![target], length: 0.0 });
        }
        let distance = |field: &[f64]| {
            around.reach().iter().map(|(v, d)| field[v.index()] + d).fold(f64::INFINITY, f64::min)
        };
        if distance(self.distances) == f64::INFINITY {
            return Err(GeodesicError::NoWay { point: target });
        }
        // Between vertices the field says no more than an upper bound, which is not good enough.
        let enough = if matches!(target, SurfacePoint::Vertex(_)) { distance(self.distances) } else { 0.0 };
        let mut rays = MAX_RAYS;
        let mut best = self.way_from(target, enough, MAX_LEGS, &mut rays);
        let length = |way: &Option<Way>| way.as_ref().map_or(f64::INFINITY, |way| way.length(self.mesh));
        if length(&best) > distance(self.distances) && length(&best) > distance(&self.tree().distances) {
            let other = self.tree().way_from(self.mesh, target).map(|way| straighten(self.mesh, way));
            if length(&other) < length(&best) {
                best = other;
            }
        }
        best.map(|way| self.path(&way)).ok_or(GeodesicError::NoWay { point: target })
    }

    /// The shortest way that is found from `target` to a source; one of length `enough` will do. It may
    /// lead over so many vertices in sight, and send so many rays.
    ///
    /// First down the field; if that is too long, straight to the vertex in sight over which the source is
    /// nearest, and from there in the same manner.
    fn way_from(&self, target: SurfacePoint, enough: f64, legs: usize, rays: &mut usize) -> Option<Way> {
        let best = descend(self, target).map(|way| straighten(self.mesh, way));
        let known = best.as_ref().map_or(f64::INFINITY, |way| way.length(self.mesh));
        if known <= enough * (1.0 + ROUNDING) || legs == 0 {
            return best;
        }
        let seen = look(self, target, known, enough, rays).and_then(|aim| {
            let rest = match aim.end {
                SurfacePoint::Vertex(vertex) => {
                    self.way_from(aim.end, self.distances[vertex.index()], legs - 1, rays)?
                }
                source => Way { nodes: vec![source], sections: Vec::new() },
            };
            let mut way = Way { nodes: vec![target], sections: vec![Section::Strip(aim.strip)] };
            way.nodes.extend(rest.nodes);
            way.sections.extend(rest.sections);
            Some(straighten(self.mesh, way))
        });
        seen.filter(|way| way.length(self.mesh) < known).or(best)
    }

    /// A way as the list of its points, from the source on.
    fn path(&self, way: &Way) -> GeodesicPath {
        let mut points = vec![way.nodes[0]];
        for (section, node) in way.sections.iter().zip(&way.nodes[1..]) {
            if let Section::Strip(strip) = section {
                points.extend(strip.portals.iter().map(|portal| portal.point()));
            }
            points.push(*node);
        }
        points.reverse();
        GeodesicPath { points, length: way.length(self.mesh) }
    }

    fn tree(&self) -> &EdgeTree {
        self.tree.get_or_init(|| EdgeTree::new(self))
    }

    fn is_source(&self, vertex: VertexId) -> bool {
        self.at_vertices.contains(&vertex)
    }

    /// The sources in a face that are no vertices.
    fn sources_within(&self, face: FaceId) -> &[SurfacePoint] {
        self.in_faces.get(&face).map_or(&[], Vec::as_slice)
    }

    /// The vertices linked to one, and how far they are.
    fn links(&self, vertex: VertexId) -> impl Iterator<Item = (VertexId, f64)> {
        let first = self.links.partition_point(|link| link.0 < vertex);
        self.links[first..].iter().take_while(move |link| link.0 == vertex).map(|link| (link.1, link.2))
    }
}

/// The same point as a vertex, or else a point of an edge, if it is one.
fn on_the_least(mesh: &IntrinsicMesh, point: SurfacePoint) -> SurfacePoint {
    match point {
        SurfacePoint::Edge { edge, t } if t <= 0.0 || t >= 1.0 => {
            SurfacePoint::Vertex(mesh.topology().edges()[edge.index()][usize::from(t >= 1.0)])
        }
        SurfacePoint::Face { face, barycentric } => {
            let Some(slot) = barycentric.iter().position(|weight| *weight <= 0.0) else { return point };
            let edge = mesh.topology().opposite_edge(CornerId::new(face, slot));
            let higher = mesh.topology().edges()[edge.index()][1];
            let vertices = mesh.topology().faces()[face.index()];
            let t = vertices.iter().zip(barycentric).find(|(v, _)| **v == higher).map_or(0.0, |(_, t)| t);
            on_the_least(mesh, SurfacePoint::Edge { edge, t })
        }
        _ => point,
    }
}
