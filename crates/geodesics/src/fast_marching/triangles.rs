//! Triangles, laid out in the order in which the front reads them.

use std::collections::HashMap;

use rayon::prelude::*;
use surface::{
    AngleSum, CornerId, EdgeGraph, FaceId, Link, Rows, Triangulation, VertexCorners, VertexId, double_area,
    scalar_product,
};

use super::window::COLLINEAR;
use crate::graph::ranks;
use crate::plane::{self, PlanePoint};

/// A triangle, laid out in the plane anticlockwise: one cache line. Corners are numbered 0, 1 and 2, sides by the corner
/// opposite. Corner 0 is at the origin, and a shortest side, the base, runs from there along the x-axis to corner 1: from
/// another one, its direction would be inaccurate in needles.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct MarchTriangle {
    pub(super) lengths: [f64; 3],
    /// Corner 2.
    pub(super) apex: PlanePoint,
    /// For each side, the next of the corners opposite to it in the triangles that share it; the same corner again if
    /// no other triangle does.
    pub(super) across: [u32; 3],
    /// The vertices with their flags.
    vertices: [u32; 3],
}

/// The flag of a vertex where shortest paths may bend.
const BENDS: u32 = 1 << 31;
/// The flag of the first vertex of a triangle a side of which is shared by more than two.
const IS_IRREGULAR: u32 = 1 << 30;

impl MarchTriangle {
    /// The vertex at a corner.
    #[inline(always)]
    pub(super) fn vertex(&self, corner: usize) -> u32 {
        self.vertices[corner] & !(BENDS | IS_IRREGULAR)
    }

    #[inline(always)]
    pub(super) fn vertices(&self) -> [u32; 3] {
        [self.vertex(0), self.vertex(1), self.vertex(2)]
    }

    /// Whether shortest paths may bend at a corner.
    #[inline(always)]
    pub(super) fn bends_at(&self, corner: usize) -> bool {
        self.vertices[corner] & BENDS != 0
    }

    /// Whether more than two triangles share a side.
    #[inline(always)]
    pub(super) fn is_irregular(&self) -> bool {
        self.vertices[0] & IS_IRREGULAR != 0
    }

    /// The length of the base.
    #[inline(always)]
    pub(super) fn base(&self) -> f64 {
        self.lengths[2]
    }

    /// Where the corners are.
    #[inline(always)]
    pub(super) fn corners(&self) -> [PlanePoint; 3] {
        [[0.0; 2], [self.base(), 0.0], self.apex]
    }

    pub(super) fn centroid(&self) -> PlanePoint {
        [(self.base() + self.apex[0]) / 3.0, self.apex[1] / 3.0]
    }

    /// The same triangle the other way round: corners 0 and 1 change places.
    #[inline]
    pub(super) fn mirrored(&self) -> Self {
        let [x, y] = self.apex;
        Self { apex: [self.base() - x, y], ..*self }
    }
}

/// The triangles of a triangulation, and what front and vertices need to find them. Vertices and triangles are
/// renumbered for locality.
#[derive(Debug)]
pub(crate) struct Triangles {
    pub(super) triangles: Vec<MarchTriangle>,
    /// The corners at every vertex.
    pub(super) corners: Rows<u32>,
    /// Straight connections of vertices outside triangles.
    pub(super) links: EdgeGraph,
    /// Vertices that join parts which no side joins: ends of links, and vertices of several fans.
    pub(super) joints: Vec<u32>,
    /// Mesh vertex of every internal number.
    pub(crate) order: Vec<u32>,
    /// Internal number of every mesh vertex.
    pub(crate) rank: Vec<u32>,
    /// The numbers of the hubs, edges of many triangles, by corner opposite. A window enters their triangles only if
    /// the middle of the edge is nearer through it than through those before.
    pub(super) hubs: HashMap<u32, u32>,
    pub(super) n_hubs: usize,
    /// The length of the longest side.
    pub(super) longest: f64,
    /// The width of the buckets to begin with.
    pub(super) bucket_width: f64,
}

/// Width of the buckets, as a share of the mean edge length. It affects time only, which `make bench-peers` measures.
const BUCKET_WIDTH: f64 = 0.3;

/// Excess of a total angle, in radians, up to which it counts as rounding: lengths leave the angles of flat triangles open by
/// about the square root of their rounding, and a path that does not bend there is too short by the square of this.
const EXCESS: f64 = 1e-6;

/// Least height of a triangle over its longest side, in lengths of that side: beyond what counts as
/// [collinear](super::window::COLLINEAR).
const LEAST_HEIGHT: f64 = 8.0 * COLLINEAR;

/// The most that this may turn its shortest side, in radians.
const LEAST_SLOPE: f64 = 1e-6;

/// Edges of more triangles are hubs.
const MOST_AROUND: usize = 8;

impl Triangles {
    /// The triangles of a triangulation whose vertices are renumbered in the given order. Windows do not cross
    /// `removed` edges, which distances follow nevertheless; links may lead anywhere.
    pub(crate) fn new(
        order: Vec<u32>,
        triangulation: &Triangulation,
        links: &[Link],
        removed: &[Link],
        mean_edge_length: f64,
    ) -> Self {
        let n = order.len();
        let rank = ranks(&order);
        let glued = triangulation.triangles();
        // Triangles follow their first vertices.
        let first = |t: usize| glued[t].vertices.iter().map(|v| rank[v.index()]).min().unwrap_or(0);
        let by_vertex = Rows::collect(n, (0..glued.len()).map(|t| (first(t) as usize, t as u32)));
        let place = by_vertex.items();
        let mut number = vec![0; glued.len()];
        for (i, t) in (0..).zip(place) {
            number[*t as usize] = i;
        }
        // The corners of every triangle are turned so that the last is opposite the shortest side.
        let first_corner = |t: usize| {
            let lengths = glued[t].lengths;
            let shortest = if lengths[1] < lengths[0] { 1 } else { 0 };
            if lengths[2] <= lengths[shortest] { 0 } else { shortest + 1 }
        };
        let renamed = |corner: CornerId| {
            let t = corner.face().index();
            3 * number[t] + ((corner.slot() + 3 - first_corner(t)) % 3) as u32
        };
        let (next, many) = around_edges(triangulation);
        let across =
            |corner| triangulation.opposite(corner).unwrap_or_else(|| *next.get(&corner).unwrap_or(&corner));
        let mut triangles: Vec<MarchTriangle> = place
            .par_iter()
            .map(|t| {
                let (face, first) = (FaceId(*t), first_corner(*t as usize));
                let corner = |slot: usize| face.corners()[(slot + first) % 3];
                let lengths = [0, 1, 2].map(|slot| glued[*t as usize].lengths[corner(slot).slot()]);
                let is_irregular = face.corners().into_iter().any(|corner| across(across(corner)) != corner);
                let mut vertices =
                    [0, 1, 2].map(|slot| rank[triangulation.corner_vertex(corner(slot)).index()]);
                vertices[0] |= if is_irregular { IS_IRREGULAR } else { 0 };
                MarchTriangle {
                    lengths,
                    apex: apex(lengths),
                    across: [0, 1, 2].map(|slot| renamed(across(corner(slot)))),
                    vertices,
                }
            })
            .collect();
        let hubs =
            (0..).zip(&many).flat_map(|(hub, edge)| edge.iter().map(move |corner| (renamed(*corner), hub)));
        let hubs = hubs.collect();
        let corners = triangles
            .iter()
            .flat_map(MarchTriangle::vertices)
            .zip(0..)
            .map(|(v, corner)| (v as usize, corner));
        let corners = Rows::collect(n, corners);
        let renumbered = |link: &Link| Link { ends: link.ends.map(|v| VertexId(rank[v.index()])), ..*link };
        let all_links = links.iter().chain(removed).map(renumbered);
        let lengths_at = |corner: u32| {
            let (t, slot) = (place[corner as usize / 3] as usize, corner as usize % 3);
            let first = first_corner(t);
            [0, 1, 2].map(|k| glued[t].lengths[(slot + first + k) % 3])
        };
        let kinds = kinds(triangulation, lengths_at, &corners, &order);
        triangles.par_iter_mut().for_each(|triangle| {
            for slot in 0..3 {
                if kinds[triangle.vertex(slot) as usize].may_bend {
                    triangle.vertices[slot] |= BENDS;
                }
            }
        });
        let mut joints: Vec<u32> = links.iter().flat_map(|link| link.ends).map(|v| rank[v.index()]).collect();
        joints.extend((0..).zip(&kinds).filter(|(_, kind)| kind.has_fans).map(|(v, _)| v));
        joints.sort_unstable();
        joints.dedup();
        let longest = glued.iter().flat_map(|t| t.lengths).chain(all_links.clone().map(|link| link.length));
        let longest = longest.fold(0.0, f64::max);
        Self {
            links: EdgeGraph::new(n, all_links),
            triangles,
            corners,
            joints,
            hubs,
            n_hubs: many.len(),
            order,
            rank,
            longest,
            bucket_width: BUCKET_WIDTH * mean_edge_length,
        }
    }

    /// The length of the longest side of a triangle.
    pub(crate) fn longest_of(&self, triangle: u32) -> f64 {
        self.at(triangle).lengths.into_iter().fold(0.0, f64::max)
    }

    /// The length of the longest edge or link at a vertex.
    pub(super) fn longest_at(&self, vertex: u32) -> f64 {
        self.ways_from(vertex).map(|(_, length)| length).fold(0.0, f64::max)
    }

    /// The mesh vertices of a triangle.
    pub(crate) fn mesh_vertices(&self, triangle: u32) -> [u32; 3] {
        self.at(triangle).vertices().map(|v| self.order[v as usize])
    }

    #[inline]
    pub(super) fn at(&self, triangle: u32) -> &MarchTriangle {
        &self.triangles[triangle as usize]
    }

    /// The edges and links at a vertex: their other ends and lengths.
    pub(super) fn ways_from(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> {
        let edges = self.corners.row(vertex as usize).iter().flat_map(|corner| self.sides_from(*corner));
        edges.chain(self.links.ways(VertexId(vertex)).iter().map(|way| (way.to.0, way.length)))
    }

    /// The two sides of a triangle that meet at a corner: their other ends and lengths.
    #[inline]
    pub(super) fn sides_from(&self, corner: u32) -> [(u32, f64); 2] {
        let (triangle, [next, prev]) = (self.at(corner / 3), around(corner as usize % 3));
        [(triangle.vertex(next), triangle.lengths[prev]), (triangle.vertex(prev), triangle.lengths[next])]
    }
}

/// The apex over the shortest side, the last. Where a flat triangle could not be flipped away, it is lifted a little, so that
/// rays from the apex cross the longest side.
fn apex([right, left, base]: [f64; 3]) -> PlanePoint {
    if base <= 0.0 {
        return [left, 0.0];
    }
    let [x, y] = plane::apex([base, left, right]);
    let longest = f64::max(left, right);
    [x, y.max(longest * f64::min(LEAST_HEIGHT * longest / base, LEAST_SLOPE))]
}

/// The next corner opposite the same edge, for edges of more than two triangles, which are free sides with the same
/// ends; and all corners of those with many triangles.
fn around_edges(triangulation: &Triangulation) -> (HashMap<CornerId, CornerId>, Vec<Vec<CornerId>>) {
    let ends = |corner: CornerId| {
        let mut ends = [corner.next(), corner.prev()].map(|end| triangulation.corner_vertex(end));
        ends.sort_unstable();
        ends
    };
    let corners = (0..3 * triangulation.triangles().len()).map(CornerId::from);
    let mut free: Vec<CornerId> =
        corners.filter(|corner| triangulation.opposite(*corner).is_none()).collect();
    free.sort_by_key(|corner| ends(*corner));
    let (mut next, mut many) = (HashMap::new(), Vec::new());
    for edge in free.chunk_by(|a, b| ends(*a) == ends(*b)).filter(|edge| edge.len() > 1) {
        let following = edge.iter().skip(1).chain(&edge[..1]);
        next.extend(edge.iter().copied().zip(following.copied()));
        if edge.len() > MOST_AROUND {
            many.push(edge.to_vec());
        }
    }
    (next, many)
}

/// What shortest paths may do at a vertex.
struct Kind {
    /// Whether they may bend.
    may_bend: bool,
    /// Whether its triangles form several fans.
    has_fans: bool,
}

/// The kinds of the vertices, in the given order; `corners` are those of the triangles at each, and `lengths_at` gives
/// the lengths of the side opposite a corner and of the two others.
fn kinds(
    triangulation: &Triangulation,
    lengths_at: impl Fn(u32) -> [f64; 3] + Sync,
    corners: &Rows<u32>,
    order: &[u32],
) -> Vec<Kind> {
    let surroundings = triangulation.vertex_corners(order.len());
    let kind = |v: usize| {
        let mut angle = AngleSum::default();
        for corner in corners.row(v) {
            let [opposite, p, q] = lengths_at(*corner);
            angle.add([double_area([opposite, p, q]), scalar_product(opposite, p, q)]);
        }
        let VertexCorners { first, n_corners, n_free } = surroundings[order[v] as usize];
        let is_closed = n_corners > 0 && n_free == 0;
        let is_inside = is_closed && triangulation.n_around(first) == n_corners as usize;
        let has_fans = n_free > 2 || (is_closed && !is_inside);
        Kind { may_bend: angle.exceeds(if is_inside { 2 } else { 1 }, EXCESS), has_fans }
    };
    (0..order.len()).into_par_iter().map(kind).collect()
}

/// The next and the previous of the three corners of a triangle.
#[inline]
pub(super) fn around(slot: usize) -> [usize; 2] {
    [[1, 2], [2, 0], [0, 1]][slot]
}
