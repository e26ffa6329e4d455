//! Triangles, laid out in the order in which the front reads them.

use std::collections::HashMap;

use rayon::prelude::*;
use surface::{
    CornerId, EdgeGraph, FaceId, GluedTriangle, Link, Rows, Triangulation, VertexId, scalar_product,
    twice_area,
};

use super::window::{COLLINEAR, SourceWindow};
use crate::order::ranks;
use crate::plane::{self, PlanePoint, around, cross, dot, sub};
use crate::prefetch::prefetch;

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
    pub(super) across: [CornerId; 3],
    /// The vertices with their flags.
    vertices: [u32; 3],
}

/// The flag of a vertex where shortest paths may bend.
const BENDS: u32 = 1 << 31;
/// The flag of the first vertex of a triangle a side of which is shared by more than two.
const IS_IRREGULAR: u32 = 1 << 30;

impl MarchTriangle {
    #[cfg(test)]
    pub(super) fn of(lengths: [f64; 3], vertices: [u32; 3]) -> Self {
        Self { lengths, apex: apex(lengths), across: [CornerId(0); 3], vertices }
    }

    /// The vertex at a corner.
    #[inline(always)]
    pub(super) fn vertex(&self, corner: usize) -> VertexId {
        VertexId(self.vertices[corner] & !(BENDS | IS_IRREGULAR))
    }

    #[inline(always)]
    pub(super) fn vertices(&self) -> [VertexId; 3] {
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

    /// The base, the apex, and a corner: what lanes of triangles hold.
    #[inline(always)]
    pub(super) fn numbers(&self, corner: usize) -> [f64; 4] {
        [self.base(), self.apex[0], self.apex[1], corner as f64]
    }

    pub(super) fn centroid(&self) -> PlanePoint {
        [(self.base() + self.apex[0]) / 3.0, self.apex[1] / 3.0]
    }

    /// Whether the last straight piece of the path of a window to the centroid crosses the side opposite a corner.
    pub(super) fn is_crossed(&self, side: usize, window: &SourceWindow) -> bool {
        let bend = window.bend(self.centroid());
        let ray = sub(self.centroid(), bend);
        let [left, right] = around(side).map(|end| cross(ray, sub(self.corners()[end], bend)));
        let slack = COLLINEAR * dot(ray, ray);
        left >= -slack && right <= slack
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
    pub(super) all: Vec<MarchTriangle>,
    /// The corners at every vertex.
    pub(super) corners: Rows<CornerId>,
    /// Straight connections of vertices outside triangles.
    pub(super) links: EdgeGraph,
    /// Vertices that join parts which no side joins: ends of links, and vertices of several fans.
    pub(super) joints: Vec<VertexId>,
    /// Mesh vertex of every internal number.
    pub(crate) order: Vec<u32>,
    /// Internal number of every mesh vertex.
    rank: Vec<u32>,
    /// The numbers of the hubs, edges of many triangles, by corner opposite. A window enters their triangles only if
    /// the middle of the edge is nearer through it than through those before.
    pub(super) hubs: HashMap<CornerId, u32>,
    pub(super) n_hubs: usize,
    /// Whether shortest paths may bend at any vertex.
    pub(super) may_bend: bool,
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
const MIN_HEIGHT: f64 = 8.0 * COLLINEAR;

/// The most that this may turn its shortest side, in radians.
const MIN_SLOPE: f64 = 1e-6;

/// Triangles that are laid out between the prefetch of one and its use. Affects speed, not results.
const AHEAD: usize = 8;

/// Edges of more triangles are hubs.
const MAX_AROUND: usize = 8;

/// The triangles of a triangulation in another order and with other corners first.
struct Renumbered<'t> {
    triangulation: &'t Triangulation,
    rank: Vec<u32>,
    /// The old number of every new one: triangles follow their first vertices.
    old: Vec<u32>,
    /// The new number of the first corner of every old triangle.
    new: Vec<CornerId>,
}

impl<'t> Renumbered<'t> {
    fn new(triangulation: &'t Triangulation, order: &[u32]) -> Self {
        let (rank, triangles) = (ranks(order), triangulation.triangles());
        let first = |t: &GluedTriangle| t.vertices.iter().map(|v| rank[v.index()]).min().unwrap_or(0);
        let firsts: Vec<u32> = triangles.par_iter().map(first).collect();
        let by_vertex = Rows::collect(order.len(), firsts.iter().map(|v| *v as usize).zip(0..));
        let old = by_vertex.items().to_vec();
        let new = ranks(&old);
        let new = new.iter().zip(triangles);
        let new = new.map(|(t, old)| CornerId::new(FaceId(*t), (3 - first_corner(old.lengths)) % 3));
        Self { triangulation, old, new: new.collect(), rank }
    }

    /// The new number of an old corner.
    fn new_corner(&self, old: CornerId) -> CornerId {
        let first = self.new[old.face().index()];
        CornerId::new(first.face(), (first.slot() + old.slot()) % 3)
    }

    /// All triangles in their new order; `across` gives the next corner opposite the same side.
    fn laid_out(&self, across: impl Fn(CornerId) -> CornerId + Sync) -> Vec<MarchTriangle> {
        let triangles = self.triangulation.triangles();
        let laid_out = |(new, old): (usize, &u32)| {
            let triangle = &triangles[*old as usize];
            if let Some(later) = self.old.get(new + AHEAD) {
                // It may be in two cache lines.
                let GluedTriangle { lengths, vertices, .. } = &triangles[*later as usize];
                prefetch(&lengths[0]);
                prefetch(&vertices[2]);
            }
            let first = first_corner(triangle.lengths);
            let slots = [first, (first + 1) % 3, (first + 2) % 3];
            let lengths = slots.map(|slot| triangle.lengths[slot]);
            let mut vertices = slots.map(|slot| self.rank[triangle.vertices[slot].index()]);
            let across = slots.map(|slot| {
                let corner = CornerId::new(FaceId(*old), slot);
                let far = across(corner);
                // A free side has no other triangle, or several.
                if far != corner && self.triangulation.opposite(corner).is_none() {
                    vertices[0] |= IS_IRREGULAR;
                }
                self.new_corner(far)
            });
            MarchTriangle { lengths, apex: apex(lengths), across, vertices }
        };
        self.old.par_iter().enumerate().map(laid_out).collect()
    }
}

/// The corner that comes first in a triangle with these sides: the last is opposite the shortest side.
fn first_corner(lengths: [f64; 3]) -> usize {
    let shortest = if lengths[1] < lengths[0] { 1 } else { 0 };
    if lengths[2] <= lengths[shortest] { 0 } else { shortest + 1 }
}

/// For every vertex whether shortest paths may bend there, and whether its triangles form several fans; `corners` are those of
/// the triangles at each.
fn kinds(triangles: &[MarchTriangle], corners: &Rows<CornerId>) -> Vec<[bool; 2]> {
    let at = |corner: CornerId| &triangles[corner.face().index()];
    let across = |side: CornerId| at(side).across[side.slot()];
    let areas: Vec<f64> = triangles.par_iter().map(|triangle| twice_area(triangle.lengths)).collect();
    // Only two triangles can be glued.
    let is_free = |side: &CornerId| {
        across(*side) == *side || (at(*side).is_irregular() && across(across(*side)) != *side)
    };
    let kind = |v: usize| {
        let sides = corners.row(v).iter().flat_map(|corner| [corner.next(), corner.prev()]);
        let n_free = sides.filter(is_free).count();
        let angles = corners.row(v).iter().map(|corner| {
            let [opposite, p, q] = [0, 1, 2].map(|step| at(*corner).lengths[(corner.slot() + step) % 3]);
            [scalar_product(opposite, p, q), areas[corner.face().index()]]
        });
        let first = corners.row(v).first().filter(|_| n_free == 0);
        let is_inside = first.is_some_and(|first| {
            // Around the vertex, until the first corner comes again.
            let (mut corner, mut is_forward, mut n) = (*first, true, 0);
            loop {
                n += 1;
                let far = across(if is_forward { corner.next() } else { corner.prev() });
                is_forward = at(far).vertex(far.next().slot()).index() == v;
                corner = if is_forward { far.next() } else { far.prev() };
                if corner == *first {
                    return n == corners.row(v).len();
                }
            }
        });
        let has_fans = n_free > 2 || (first.is_some() && !is_inside);
        [exceed(angles, if is_inside { 2 } else { 1 }), has_fans]
    };
    (0..corners.n_rows()).into_par_iter().map(kind).collect()
}

/// Whether angles are more than so many half turns together. Each is given by a multiple of its cosine and sine: products of complex
/// numbers take a fraction of the time of arc tangents.
fn exceed(angles: impl Iterator<Item = PlanePoint>, half_turns: usize) -> bool {
    // The sum is this direction, which is never below the axis, after so many half turns.
    let ([mut x, mut y], mut n) = ([1.0, 0.0], 0);
    for [cos, sin] in angles {
        [x, y] = [x * cos - y * sin, x * sin + y * cos];
        if y < 0.0 || (y == 0.0 && x < 0.0) {
            ([x, y], n) = ([-x, -y], n + 1);
        }
        let size = x.abs() + y;
        [x, y] = [x / size, y / size];
    }
    n > half_turns || (n == half_turns && y > EXCESS * x)
}

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
        let renumbered = Renumbered::new(triangulation, &order);
        let (next, many) = around_edges(triangulation);
        let across =
            |corner| triangulation.opposite(corner).unwrap_or_else(|| *next.get(&corner).unwrap_or(&corner));
        let mut all = renumbered.laid_out(across);
        let hubs = (0..).zip(&many).flat_map(|(hub, edge)| edge.iter().map(move |corner| (*corner, hub)));
        let hubs = hubs.map(|(corner, hub)| (renumbered.new_corner(corner), hub)).collect();
        let at_vertex = all.iter().flat_map(MarchTriangle::vertices).zip((0..).map(CornerId));
        let corners = Rows::collect(order.len(), at_vertex.map(|(v, corner)| (v.index(), corner)));
        let kinds = kinds(&all, &corners);
        all.par_iter_mut().for_each(|triangle| {
            for slot in 0..3 {
                let [may_bend, _] = kinds[triangle.vertex(slot).index()];
                triangle.vertices[slot] |= if may_bend { BENDS } else { 0 };
            }
        });
        let rank = renumbered.rank;
        let new = |v: VertexId| VertexId(rank[v.index()]);
        let mut joints: Vec<VertexId> = links.iter().flat_map(|link| link.ends).map(new).collect();
        joints.extend((0..).map(VertexId).zip(&kinds).filter(|(_, [_, has_fans])| *has_fans).map(|(v, _)| v));
        joints.sort_unstable();
        joints.dedup();
        let links = links.iter().chain(removed).map(|link| Link { ends: link.ends.map(new), ..*link });
        let sides = triangulation.triangles().iter().flat_map(|triangle| triangle.lengths);
        let longest = sides.chain(links.clone().map(|link| link.length)).fold(0.0, f64::max);
        Self {
            links: EdgeGraph::new(order.len(), links),
            all,
            corners,
            joints,
            hubs,
            n_hubs: many.len(),
            may_bend: kinds.iter().any(|[may_bend, _]| *may_bend),
            order,
            rank,
            longest,
            bucket_width: BUCKET_WIDTH * mean_edge_length,
        }
    }

    /// The internal number of a mesh vertex.
    #[inline]
    pub(super) fn number(&self, v: VertexId) -> VertexId {
        VertexId(self.rank[v.index()])
    }

    #[inline]
    pub(super) fn at(&self, triangle: FaceId) -> &MarchTriangle {
        &self.all[triangle.index()]
    }

    /// The edges and links at a vertex: their other ends and lengths.
    pub(super) fn ways_from(&self, vertex: VertexId) -> impl Iterator<Item = (VertexId, f64)> {
        let edges = self.corners.row(vertex.index()).iter().flat_map(|corner| self.sides_from(*corner));
        edges.chain(self.links.ways(vertex).iter().map(|way| (way.to, way.length)))
    }

    /// The two sides of a triangle that meet at a corner: their other ends and lengths.
    #[inline]
    pub(super) fn sides_from(&self, corner: CornerId) -> [(VertexId, f64); 2] {
        let (triangle, [next, prev]) = (self.at(corner.face()), around(corner.slot()));
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
    [x, y.max(longest * f64::min(MIN_HEIGHT * longest / base, MIN_SLOPE))]
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
        if edge.len() > MAX_AROUND {
            many.push(edge.to_vec());
        }
    }
    (next, many)
}
