//! The one-rings of all vertices, laid out in the order in which relaxations read them.

use std::collections::HashMap;

use rayon::prelude::*;
use surface::{
    AngleSum, CornerId, CornerTable, Link, OneRing, Rows, Sector, Topology, Triangulation, VertexCorners,
    VertexId, VertexKind, Winding, double_area, scalar_product,
};

use super::update::Stencil;
use crate::graph::ranks;
use crate::prefetch::prefetch;

/// A neighbour of a vertex: the edge to it, and the triangle between this neighbour and the one before it.
///
/// 32 bytes. The neighbours of a vertex follow its fans. An interior vertex has a single closed fan: then each
/// triangle lies between two neighbours, the first and the last one included, and is visited once. Any other fan
/// begins with a neighbour that has no triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Neighbour {
    pub(super) vertex: u32,
    pub(super) allowed: Allowed,
    /// Length of the edge.
    pub(super) length: f64,
    /// Scalar product of this edge and the one before, laid out in the plane of their triangle.
    pub(super) dot: f64,
    /// Twice the area of that triangle.
    pub(super) cross: f64,
}

impl Neighbour {
    /// A neighbour without a triangle.
    fn without_triangle(vertex: u32, allowed: Allowed, length: f64) -> Self {
        Self { vertex, allowed, length, dot: 0.0, cross: 0.0 }
    }

    /// A neighbour with the triangle between it and one before.
    #[inline]
    fn through(sector: Sector, allowed: Allowed) -> Self {
        let Sector { end, first, last, third } = sector;
        let (dot, cross) = (scalar_product(third, first, last), double_area([third, first, last]));
        let backward = Stencil { base: last, side: first, dot, cross };
        let forward = Stencil { base: first, side: last, dot, cross };
        // Without branches, which could not be predicted.
        let flags = |stencil: Stencil| {
            let nearby = u32::from(stencil.may_complete_late()) * Allowed::LATE_NEARBY.0;
            nearby | (u32::from(stencil.may_complete_late_from_afar()) * Allowed::LATE.0)
        };
        let late = Allowed(flags(backward) | (flags(forward) << 1));
        Self { vertex: end.0, allowed: allowed.and(late), length: last, dot, cross }
    }
}

/// The relaxations allowed at a neighbour: a set of flags.
///
/// A flag for a backward update is followed by the same flag for the forward update.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Allowed(u32);

impl Allowed {
    const NONE: Self = Self(0);
    /// Update the neighbour before through the triangle, from this edge.
    const BACKWARD: Self = Self(1);
    /// Update this neighbour through the triangle, from the edge before.
    const FORWARD: Self = Self(2);
    /// Update even if the neighbour was finalized before the vertex, at any distance from the source.
    const LATE: Self = Self(4);
    /// The same, but only close to the source.
    const LATE_NEARBY: Self = Self(16);
    /// Relax the edge.
    pub(super) const EDGE: Self = Self(64);
    /// All that a triangle of the surface allows at a neighbour.
    const TRIANGLE: Self = Self(Self::BACKWARD.0 | Self::FORWARD.0 | Self::EDGE.0);

    /// What a front may do, depending on whether it corrects finalized vertices and is close to its source.
    pub(super) fn by_front(corrects: bool, is_nearby: bool) -> Self {
        let both_ways = |flag: Self| flag.and(Self(flag.0 << 1));
        let all = both_ways(Self::BACKWARD).and(Self::EDGE);
        match (corrects, is_nearby) {
            (false, _) => all,
            (true, false) => all.and(both_ways(Self::LATE)),
            (true, true) => all.and(both_ways(Self::LATE)).and(both_ways(Self::LATE_NEARBY)),
        }
    }

    #[inline]
    pub(super) fn has(self, flag: Self) -> bool {
        self.0 & flag.0 != 0
    }

    fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    #[inline]
    pub(super) fn only(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// Whether a forward or backward update is allowed, to a vertex that is ahead of the front or not.
    #[inline]
    pub(super) fn has_update(self, is_forward: bool, is_ahead: bool) -> bool {
        let flags = self.0 >> u32::from(is_forward);
        flags & (u32::from(is_ahead) | flags >> 2 | flags >> 4) & 1 != 0
    }
}

/// Half of an obtuse corner that unfolding has split, at one end of its base: a triangle that is used in one
/// direction only, from the base to the apex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HalfCorner {
    /// The other end of the base, and its distance.
    pub(super) base: (u32, f64),
    /// The vertex in the obtuse corner, and its distance.
    pub(super) apex: (u32, f64),
    /// The length of the third side.
    pub(super) third: f64,
}

/// The one-rings of all vertices, which are renumbered for locality.
#[derive(Debug)]
pub(super) struct OneRings {
    neighbours: Rows<Neighbour>,
    /// Whether shortest paths may bend at a vertex.
    may_bend: Vec<bool>,
    /// Mesh vertex of every internal number.
    pub(super) order: Vec<u32>,
    /// Internal number of every mesh vertex.
    pub(super) rank: Vec<u32>,
    /// The length of the longest edge.
    pub(super) longest: f64,
    /// The width of the buckets to begin with.
    pub(super) bucket_width: f64,
}

/// Width of the buckets, as a share of the mean edge length. In wider buckets more vertices have to be corrected, in
/// narrower ones too few are handled together. It affects time only, which `make bench` measures.
const BUCKET_WIDTH: f64 = 0.05;

/// Number of vertices whose one-rings one thread lays out at a time.
const BLOCK: usize = 1024;

/// How many vertices ahead their triangles are requested, and at most how many of them for each.
const AHEAD: usize = 6;
const MOST_AHEAD: usize = 16;

/// Excess of a total angle, in radians, up to which it counts as rounding.
pub(super) const EXCESS: f64 = 5e-9;

impl OneRings {
    /// The one-rings of a triangulation of a mesh with the given connectivity, whose vertices are renumbered in the given order, with straight connections
    /// and halves of obtuse corners (by the vertex that they are at) in addition.
    ///
    /// The mean edge length is that of the mesh: after flips, it may depend on the numbering of the vertices.
    pub(super) fn new(
        order: Vec<u32>,
        topology: Option<&Topology>,
        triangulation: &Triangulation,
        links: &[Link],
        halves: &[(u32, HalfCorner)],
        mean_edge_length: f64,
    ) -> Self {
        let n = order.len();
        let rank = ranks(&order);
        let halves = Rows::collect(n, halves.iter().map(|(v, half)| (*v as usize, *half)));
        let mut layout = RingLayout {
            topology,
            triangulation,
            around: triangulation.vertex_corners(n),
            links: Link::by_vertex(n, links.iter().copied()),
            halves,
            has_fans: Vec::new(),
            corners: Rows::default(),
            order,
            rank,
        };
        let Filled { neighbours, may_bend, longest } = layout.fill();
        let RingLayout { order, rank, .. } = layout;
        Self { neighbours, may_bend, order, rank, longest, bucket_width: BUCKET_WIDTH * mean_edge_length }
    }

    #[inline]
    pub(super) fn of(&self, vertex: u32) -> &[Neighbour] {
        self.neighbours.row(vertex as usize)
    }

    /// The numbers of the neighbours of a vertex among [all](Self::at): the first, and the one after the last.
    #[inline]
    pub(super) fn range_of(&self, vertex: u32) -> [u32; 2] {
        let range = self.neighbours.range(vertex as usize);
        [range.start as u32, range.end as u32]
    }

    #[inline]
    pub(super) fn at(&self, neighbour: u32) -> &Neighbour {
        &self.neighbours.items()[neighbour as usize]
    }

    pub(super) fn longest_at(&self, vertex: u32) -> f64 {
        self.of(vertex).iter().map(|neighbour| neighbour.length).fold(0.0, f64::max)
    }

    /// Whether shortest paths may bend at a vertex, because it is a saddle vertex, a boundary vertex with more than
    /// 180 degrees, or irregular.
    #[inline]
    pub(super) fn may_bend(&self, vertex: u32) -> bool {
        self.may_bend[vertex as usize]
    }
}

/// What the one-rings are made of.
struct RingLayout<'a> {
    /// The connectivity of the mesh, if it is still there; a few edges may have been flipped since.
    topology: Option<&'a Topology>,
    triangulation: &'a Triangulation,
    around: Vec<VertexCorners>,
    links: Rows<(u32, f64)>,
    halves: Rows<HalfCorner>,
    /// Whether all corners of a vertex are listed, because its faces may not form a closed fan.
    has_fans: Vec<bool>,
    /// The corners of such vertices.
    corners: Rows<CornerId>,
    order: Vec<u32>,
    rank: Vec<u32>,
}

/// The one-rings laid out.
struct Filled {
    neighbours: Rows<Neighbour>,
    may_bend: Vec<bool>,
    longest: f64,
}

/// Memory for laying out one vertex after the other.
#[derive(Default)]
struct RingScratch {
    ring: OneRing,
    neighbours: Vec<Neighbour>,
}

impl RingLayout<'_> {
    /// Lays out all one-rings in place, in parallel. Their sizes are computed before. Where that is wrong, in rare
    /// cases, they are corrected and all is laid out again.
    fn fill(&mut self) -> Filled {
        self.has_fans = self.around.iter().map(|at| at.n_free > 0).collect();
        self.list_corners();
        let mut sizes: Vec<u32> = self.order.par_iter().map(|v| self.likely_size(*v)).collect();
        loop {
            match self.try_fill(&sizes) {
                Ok(filled) => return filled,
                Err(wrong) => {
                    wrong.iter().for_each(|i| self.has_fans[self.order[*i] as usize] = true);
                    self.list_corners();
                    let mut scratch = RingScratch::default();
                    for i in wrong {
                        self.lay_out(self.order[i], &mut scratch);
                        sizes[i] = scratch.neighbours.len() as u32;
                    }
                }
            }
        }
    }

    /// Lists the corners of the vertices that may have several fans.
    fn list_corners(&mut self) {
        if self.has_fans.iter().any(|has_fans| *has_fans) {
            let corners = (0..3 * self.triangulation.triangles().len()).map(CornerId::from);
            let corners = corners.map(|c| (self.triangulation.corner_vertex(c).index(), c));
            self.corners = Rows::collect(self.order.len(), corners.filter(|(v, _)| self.has_fans[*v]));
        }
    }

    /// The number of neighbours of a vertex whose faces form open fans or a single closed one, if every link leads
    /// elsewhere than the edges.
    fn likely_size(&self, v: u32) -> u32 {
        let (at, links, halves) =
            (self.around[v as usize], self.links.row(v as usize), self.halves.row(v as usize));
        let n_open = at.n_free / 2;
        let closes = at.n_corners > 0 && n_open == 0 && !(links.is_empty() && halves.is_empty());
        at.n_corners + n_open + u32::from(closes) + (links.len() + 2 * halves.len()) as u32
    }

    /// Lays out one-rings of the given sizes, or returns the vertices that have others.
    fn try_fill(&self, sizes: &[u32]) -> Result<Filled, Vec<usize>> {
        let mut offsets = Vec::with_capacity(sizes.len() + 1);
        let mut total = 0u64;
        offsets.push(0);
        offsets.extend(sizes.iter().map(|size| {
            total += u64::from(*size);
            total as u32
        }));
        assert!(u32::try_from(total).is_ok(), "more neighbours than fit into 32 bits");
        let mut neighbours = vec![Neighbour::without_triangle(0, Allowed::NONE, 0.0); total as usize];
        let mut may_bend = vec![false; sizes.len()];
        let mut rest = &mut neighbours[..];
        let blocks: Vec<_> = may_bend
            .chunks_mut(BLOCK)
            .zip(sizes.chunks(BLOCK))
            .map(|(may_bend, sizes)| {
                let n: usize = sizes.iter().map(|size| *size as usize).sum();
                let (block, after) = std::mem::take(&mut rest).split_at_mut(n);
                rest = after;
                (may_bend, sizes, block)
            })
            .collect();
        let blocks: Vec<(f64, Vec<usize>)> = blocks
            .into_par_iter()
            .enumerate()
            .map_init(RingScratch::default, |scratch, (block, (may_bend, sizes, mut rest))| {
                let (mut longest, mut wrong) = (0.0, Vec::new());
                for (i, (may_bend, size)) in (block * BLOCK..).zip(may_bend.iter_mut().zip(sizes)) {
                    self.prefetch(i);
                    *may_bend = self.lay_out(self.order[i], scratch);
                    let (place, after) = rest.split_at_mut(*size as usize);
                    rest = after;
                    if place.len() == scratch.neighbours.len() {
                        place.copy_from_slice(&scratch.neighbours);
                        longest = place.iter().map(|n| n.length).fold(longest, f64::max);
                    } else {
                        wrong.push(i);
                    }
                }
                (longest, wrong)
            })
            .collect();
        let longest = blocks.iter().map(|(longest, _)| *longest).fold(0.0, f64::max);
        let wrong: Vec<usize> = blocks.into_iter().flat_map(|(_, wrong)| wrong).collect();
        match wrong.is_empty() {
            true => Ok(Filled { neighbours: Rows::from_offsets(offsets, neighbours), may_bend, longest }),
            false => Err(wrong),
        }
    }

    /// Requests what vertices a little after number `i` need. A walk around a vertex finds each triangle through the one
    /// before, so it would wait for each of them.
    fn prefetch(&self, i: usize) {
        let Some(topology) = self.topology else { return };
        if let Some(v) = self.order.get(i + 2 * AHEAD) {
            let v = *v as usize;
            prefetch(topology.vertex_corners(VertexId(v as u32)));
            prefetch(&self.around[v..=v]);
        }
        if let Some(v) = self.order.get(i + AHEAD) {
            for corner in topology.vertex_corners(VertexId(*v)).iter().take(MOST_AHEAD) {
                let triangle = corner.face().index();
                prefetch(&self.triangulation.triangles()[triangle..=triangle]);
            }
        }
    }

    /// Lays out the neighbours of a mesh vertex in `scratch`; returns whether shortest paths may bend there.
    fn lay_out(&self, v: u32, scratch: &mut RingScratch) -> bool {
        let RingScratch { ring, neighbours } = scratch;
        let v = v as usize;
        let (around, links, halves) = (&self.around[v], self.links.row(v), self.halves.row(v));
        neighbours.clear();
        let (mut angle, mut is_closed) = (AngleSum::default(), false);
        let may_bend = if self.has_fans[v] {
            ring.collect(self.triangulation, self.corners.row(v));
            is_closed = ring.is_closed();
            add_fans(self.triangulation, ring, neighbours, &mut angle);
            match ring.kind(angle.radians(), EXCESS) {
                VertexKind::Ordinary => false,
                VertexKind::Saddle | VertexKind::Boundary => true,
                VertexKind::Irregular => angle.exceeds(1, EXCESS),
            }
        } else if around.n_corners > 0 {
            is_closed = true;
            neighbours.push(Neighbour::without_triangle(0, Allowed::NONE, 0.0));
            let n_corners = self.triangulation.walk_around(around.first, |sector| {
                let neighbour = Neighbour::through(sector, Allowed::TRIANGLE);
                angle.add([neighbour.cross, neighbour.dot]);
                neighbours.push(neighbour);
            });
            if n_corners != around.n_corners as usize {
                // Several fans: without neighbours, the size is wrong.
                neighbours.clear();
                return false;
            }
            let Neighbour { vertex, length, .. } = neighbours[n_corners];
            neighbours[0] = Neighbour::without_triangle(vertex, Allowed::EDGE, length);
            angle.exceeds(2, EXCESS)
        } else {
            false
        };
        let n_fans = neighbours.len();
        for HalfCorner { base, apex, third } in halves {
            let sector = Sector { end: VertexId(apex.0), first: base.1, last: apex.1, third: *third };
            neighbours.push(Neighbour::without_triangle(base.0, Allowed::NONE, base.1));
            neighbours.push(Neighbour::through(sector, Allowed::FORWARD));
        }
        add_links(links, neighbours);
        if is_closed && neighbours.len() == n_fans {
            // The neighbour that closes the fan takes the place of its copy at the beginning.
            neighbours.swap_remove(0);
        }
        for neighbour in neighbours {
            neighbour.vertex = self.rank[neighbour.vertex as usize];
        }
        may_bend
    }
}

/// Appends the neighbours in the fans of a vertex, and adds up the angles.
fn add_fans(
    triangulation: &Triangulation,
    ring: &OneRing,
    neighbours: &mut Vec<Neighbour>,
    angle: &mut AngleSum,
) {
    let vertex = |corner| triangulation.corner_vertex(corner);
    for fan in ring.fans() {
        for (i, corner) in fan.corners.iter().enumerate() {
            let [third, to_next, to_prev] = triangulation.sides(corner.corner);
            let [first, last] = match corner.winding {
                Winding::Forward => [to_next, to_prev],
                Winding::Backward => [to_prev, to_next],
            };
            if i == 0 {
                let start = vertex(corner.opposite_last());
                neighbours.push(Neighbour::without_triangle(start.0, Allowed::EDGE, first));
            }
            let sector = Sector { end: vertex(corner.opposite_first()), first, last, third };
            let neighbour = Neighbour::through(sector, Allowed::TRIANGLE);
            angle.add([neighbour.cross, neighbour.dot]);
            neighbours.push(neighbour);
        }
    }
}

/// Up to this many links at a vertex are compared with all of its neighbours.
const FEW_LINKS: usize = 16;

/// Appends the ends of links, except where an edge or an earlier link is no longer.
fn add_links(links: &[(u32, f64)], neighbours: &mut Vec<Neighbour>) {
    let has_edge = |n: &&Neighbour| n.allowed.has(Allowed::EDGE);
    let appended = |(end, length): (u32, f64)| Neighbour::without_triangle(end, Allowed::EDGE, length);
    if links.len() <= FEW_LINKS {
        for &(end, length) in links {
            if !neighbours.iter().filter(has_edge).any(|n| n.vertex == end && n.length <= length) {
                neighbours.push(appended((end, length)));
            }
        }
        return;
    }
    let mut shortest = HashMap::with_capacity(neighbours.len() + links.len());
    for n in neighbours.iter().filter(has_edge) {
        let known = shortest.entry(n.vertex).or_insert(f64::INFINITY);
        *known = n.length.min(*known);
    }
    for &(end, length) in links {
        let known = shortest.entry(end).or_insert(f64::INFINITY);
        if length < *known || *known == f64::INFINITY {
            *known = length;
            neighbours.push(appended((end, length)));
        }
    }
}
