//! Triangles, laid out in the order in which the front reads them.

use std::collections::HashMap;

use rayon::prelude::*;
use surface::{
    AngleSum, CornerId, CornerTable, FaceId, Link, Rows, Triangulation, VertexCorners, VertexId, double_area,
    scalar_product,
};

use super::super::one_ring::EXCESS;
use super::crossing::Sides;
use super::window::Entered;
use crate::graph::ranks;

/// A triangle: one cache line. Corners are numbered 0, 1 and 2, sides by the corner opposite.
#[derive(Debug, Clone, Copy)]
#[repr(align(64))]
pub(super) struct MarchTriangle {
    pub(super) lengths: [f64; 3],
    double_area: f64,
    /// For each side, the next of the corners opposite to it in the triangles that share it; the same corner again if
    /// no other triangle does.
    pub(super) across: [u32; 3],
    pub(super) vertices: [u32; 3],
    flags: u32,
}

/// A corner and the side opposite, through which the triangle is entered.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct EntrySide(u32);

impl EntrySide {
    /// Whether the next corner is the right end of the side, not the left one.
    const MIRRORED: u32 = 1 << 31;

    pub(super) fn new(corner: u32, is_mirrored: bool) -> Self {
        Self(corner | if is_mirrored { Self::MIRRORED } else { 0 })
    }

    pub(super) fn number(self) -> u32 {
        self.0
    }

    pub(super) fn numbered(number: u32) -> Self {
        Self(number)
    }

    pub(super) fn triangle(self) -> u32 {
        (self.0 & !Self::MIRRORED) / 3
    }

    pub(super) fn is_mirrored(self) -> bool {
        self.0 & Self::MIRRORED != 0
    }

    /// The corners at the left and right end of the side, and the one opposite.
    #[inline]
    pub(super) fn corners(self) -> [usize; 3] {
        let apex = (self.0 & !Self::MIRRORED) as usize % 3;
        let [next, prev] = around(apex);
        if self.is_mirrored() { [prev, next, apex] } else { [next, prev, apex] }
    }
}

impl MarchTriangle {
    /// The flag of the first corner's vertex: shortest paths may bend there.
    const BENDS: u32 = 1;

    /// The lengths of the triangle as seen through the side where it is entered.
    #[inline]
    pub(super) fn sides(&self, entry: EntrySide) -> Sides {
        let [left, right, apex] = entry.corners();
        Sides {
            base: self.lengths[apex],
            from_left: self.lengths[right],
            from_right: self.lengths[left],
            double_area: self.double_area,
        }
    }

    /// Whether shortest paths may bend at the left and at the right end of an entry.
    #[inline]
    pub(super) fn bends(&self, entry: EntrySide) -> [bool; 2] {
        let [left, right, _] = entry.corners();
        [left, right].map(|corner| self.flags & (Self::BENDS << corner) != 0)
    }

    /// The triangle laid out above an entry.
    #[inline]
    pub(super) fn entered(&self, entry: EntrySide) -> Entered {
        let sides = self.sides(entry);
        Entered { base: sides.base, apex: sides.apex() }
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
    pub(super) links: Rows<(u32, f64)>,
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
        let renamed = |corner: CornerId| 3 * number[corner.face().index()] + corner.slot() as u32;
        let (next, many) = around_edges(triangulation);
        let across =
            |corner| triangulation.opposite(corner).unwrap_or_else(|| *next.get(&corner).unwrap_or(&corner));
        let mut triangles: Vec<MarchTriangle> = place
            .par_iter()
            .map(|t| {
                let face = FaceId(*t);
                let lengths = glued[face.index()].lengths;
                MarchTriangle {
                    lengths,
                    double_area: double_area(lengths),
                    across: face.corners().map(|corner| renamed(across(corner))),
                    vertices: glued[face.index()].vertices.map(|v| rank[v.index()]),
                    flags: 0,
                }
            })
            .collect();
        let hubs =
            (0..).zip(&many).flat_map(|(hub, edge)| edge.iter().map(move |corner| (renamed(*corner), hub)));
        let hubs = hubs.collect();
        let corners = triangles.iter().enumerate().flat_map(|(t, triangle)| {
            [0, 1, 2].map(|slot| (triangle.vertices[slot] as usize, (3 * t + slot) as u32))
        });
        let corners = Rows::collect(n, corners);
        let renumbered = |link: &Link| Link { ends: link.ends.map(|v| VertexId(rank[v.index()])), ..*link };
        let all_links = links.iter().chain(removed).map(renumbered);
        let kinds = kinds(triangulation, &triangles, &corners, &order);
        triangles.par_iter_mut().for_each(|triangle| {
            for slot in 0..3 {
                if kinds[triangle.vertices[slot] as usize].may_bend {
                    triangle.flags |= MarchTriangle::BENDS << slot;
                }
            }
        });
        let mut joints: Vec<u32> = links.iter().flat_map(|link| link.ends).map(|v| rank[v.index()]).collect();
        joints.extend((0..).zip(&kinds).filter(|(_, kind)| kind.has_fans).map(|(v, _)| v));
        joints.sort_unstable();
        joints.dedup();
        let longest =
            triangles.iter().flat_map(|t| t.lengths).chain(all_links.clone().map(|link| link.length));
        let longest = longest.fold(0.0, f64::max);
        Self {
            links: Link::by_vertex(n, all_links),
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

    /// The mesh vertices of a triangle.
    pub(crate) fn mesh_vertices(&self, triangle: u32) -> [u32; 3] {
        self.at(triangle).vertices.map(|v| self.order[v as usize])
    }

    #[inline]
    pub(super) fn at(&self, triangle: u32) -> &MarchTriangle {
        &self.triangles[triangle as usize]
    }

    /// The edges and links at a vertex: their other ends and lengths.
    pub(super) fn ways_from(&self, vertex: u32) -> impl Iterator<Item = (u32, f64)> {
        let edges = self.corners.row(vertex as usize).iter().flat_map(|corner| {
            let (triangle, slot) = (self.at(corner / 3), *corner as usize % 3);
            let [next, prev] = around(slot);
            [
                (triangle.vertices[next], triangle.lengths[prev]),
                (triangle.vertices[prev], triangle.lengths[next]),
            ]
        });
        edges.chain(self.links.row(vertex as usize).iter().copied())
    }
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

/// The kinds of the vertices, in the given order; `corners` are those of the triangles at each.
fn kinds(
    triangulation: &Triangulation,
    triangles: &[MarchTriangle],
    corners: &Rows<u32>,
    order: &[u32],
) -> Vec<Kind> {
    let surroundings = triangulation.vertex_corners(order.len());
    let kind = |v: usize| {
        let mut angle = AngleSum::default();
        for corner in corners.row(v) {
            let (t, slot) = (&triangles[*corner as usize / 3], *corner as usize % 3);
            let [next, prev] = around(slot);
            angle.add([t.double_area, scalar_product(t.lengths[slot], t.lengths[next], t.lengths[prev])]);
        }
        let VertexCorners { first, n_corners, n_free } = surroundings[order[v] as usize];
        let is_closed = n_corners > 0 && n_free == 0;
        let is_inside = is_closed && triangulation.walk_around(first, |_| {}) == n_corners as usize;
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
