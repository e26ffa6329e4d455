//! What a vertex does when the front leaves it, laid out in the order in which it is needed.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;
use surface::Rows;

use super::chains::{Chains, Part, Strung, is_cut, total_angle};
use super::triangulation::Triangulation;
use super::update::Sector;

/// A straight way from a vertex to another, and the triangle between it and the spoke before.
///
/// The spokes of a vertex form chains. Around an ordinary vertex there is one, and it is closed: each
/// triangle is met once, between two spokes, the first and the last one included, and each neighbour is
/// looked at once.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Spoke {
    /// The vertex at its end.
    pub(super) end: u32,
    pub(super) ways: Ways,
    pub(super) length: f64,
    /// Scalar product of this spoke and the one before in the plane of their triangle.
    pub(super) dot: f64,
    /// Twice the area of that triangle.
    pub(super) cross: f64,
}

impl Spoke {
    /// The triangle behind this spoke, seen by a front on its way from the spoke before to this one.
    fn onward_from(&self, before: &Self) -> Sector {
        Sector { base: before.length, side: self.length, dot: self.dot, cross: self.cross }
    }

    /// The same for a front from this spoke to the one before.
    fn back_to(&self, before: &Self) -> Sector {
        Sector { base: self.length, side: before.length, dot: self.dot, cross: self.cross }
    }

    /// Finds out which ways through the triangle may be completed late.
    fn set_late_ways(&mut self, before: &Self) {
        for (sector, shift) in [(self.back_to(before), 0), (self.onward_from(before), 1)] {
            if sector.may_complete_late() {
                self.ways.0 |= Ways::LATE_NEARBY.0 << shift;
            }
            if sector.may_complete_late_from_afar() {
                self.ways.0 |= Ways::LATE.0 << shift;
            }
        }
    }
}

/// What the front may do at a spoke: a set of flags.
///
/// A flag of a way back through the triangle is followed by the same flag of the way onward.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Ways(u32);

impl Ways {
    pub(super) const NONE: Self = Self(0);
    /// Go through the triangle, over this spoke, to the end of the one before.
    pub(super) const BACK: Self = Self(1);
    /// Go through the triangle, over the spoke before, to the end of this one.
    pub(super) const ONWARD: Self = Self(2);
    /// Do so although the front has been there before it came to the vertex, wherever the source is.
    const LATE: Self = Self(4);
    /// The same, unless the source is far away.
    const LATE_NEARBY: Self = Self(16);
    /// Go along the spoke.
    pub(super) const ALONG: Self = Self(64);

    /// What a front may do that does or does not correct what it has passed, near its source or far away.
    pub(super) fn of_front(corrects: bool, is_nearby: bool) -> Self {
        let both_ways = |way: Self| way.and(Self(way.0 << 1));
        let all = both_ways(Self::BACK).and(Self::ALONG);
        match (corrects, is_nearby) {
            (false, _) => all,
            (true, false) => all.and(both_ways(Self::LATE)),
            (true, true) => all.and(both_ways(Self::LATE)).and(both_ways(Self::LATE_NEARBY)),
        }
    }

    #[inline]
    pub(super) fn allow(self, way: Self) -> bool {
        self.0 & way.0 != 0
    }

    pub(super) fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    #[inline]
    pub(super) fn only(self, others: Self) -> Self {
        Self(self.0 & others.0)
    }

    /// Whether the front may go through the triangle, onward or back, to a vertex that is ahead of it or not.
    #[inline]
    pub(super) fn allow_through(self, is_onward: bool, is_ahead: bool) -> bool {
        let ways = self.0 >> u32::from(is_onward);
        ways & (u32::from(is_ahead) | ways >> 2 | ways >> 4) & 1 != 0
    }
}

/// The spokes of every vertex, stored back to back, over vertices renumbered for locality.
#[derive(Debug, Clone)]
pub(super) struct Spokes {
    offsets: Vec<u32>,
    spokes: Vec<Spoke>,
    /// Whether shortest ways may bend at a vertex.
    bends: Vec<bool>,
    /// Mesh vertex of every internal number.
    pub(super) order: Vec<u32>,
    /// Internal number of every mesh vertex.
    pub(super) rank: Vec<u32>,
    /// The length of the longest spoke.
    pub(super) longest: f64,
    /// How wide the bands of a front should be.
    pub(super) band: f64,
}

/// How wide the bands of a front are, as a share of the mean length of an edge. In wider ones more vertices have
/// to be corrected, in narrower ones too few are dealt with together.
const BAND: f64 = 0.05;

/// Vertices whose spokes are made by one thread at a time.
const BLOCK: usize = 1024;

/// The spokes of some vertices.
#[derive(Debug, Default)]
struct Block {
    spokes: Vec<Spoke>,
    /// How many each vertex has.
    counts: Vec<u32>,
    bends: Vec<bool>,
}

/// Angles that exceed a straight one by less than this share do so by rounding.
const STRAIGHT: f64 = 1.0 + 1e-9;

impl Spokes {
    #[inline]
    pub(super) fn of(&self, vertex: u32) -> &[Spoke] {
        let v = vertex as usize;
        &self.spokes[self.offsets[v] as usize..self.offsets[v + 1] as usize]
    }

    /// The spoke of this number.
    #[inline]
    pub(super) fn at(&self, spoke: u32) -> &Spoke {
        &self.spokes[spoke as usize]
    }

    /// The numbers of the first spoke of a vertex and of the first one that is no more one of its.
    #[inline]
    pub(super) fn range_of(&self, vertex: u32) -> [u32; 2] {
        [self.offsets[vertex as usize], self.offsets[vertex as usize + 1]]
    }

    /// The length of the longest spoke of a vertex.
    pub(super) fn longest_of(&self, vertex: u32) -> f64 {
        self.of(vertex).iter().map(|spoke| spoke.length).fold(0.0, f64::max)
    }

    /// Whether shortest ways may bend at a vertex: where more than 360 degrees meet, and at
    /// boundaries more than 180.
    #[inline]
    pub(super) fn bend_at(&self, vertex: u32) -> bool {
        self.bends[vertex as usize]
    }

    /// The spokes of a triangulation, with further parts of vertices from elsewhere, over vertices in an
    /// order in which neighbours are close.
    ///
    /// The mean length of an edge is that of the mesh: after flips it may depend on the numbering of vertices.
    pub(super) fn new(
        order: Vec<u32>,
        triangulation: &Triangulation,
        extras: &[(u32, Part)],
        mean_edge_length: f64,
    ) -> Self {
        let mut rank = vec![0; order.len()];
        for (internal, v) in order.iter().enumerate() {
            rank[*v as usize] = internal as u32;
        }
        let corners = triangulation.corners();
        let segments = triangulation.segments.iter().flat_map(|(ends, length)| Part::segment(*ends, *length));
        let extras = extras.iter().copied().chain(segments).map(|(v, part)| (v as usize, part));
        let extras = Rows::collect(order.len(), extras);
        let blocks: Vec<Block> = order
            .par_chunks(BLOCK)
            .map(|vertices| {
                let mut block = Block::default();
                let (mut parts, mut chains) = (Vec::new(), Chains::default());
                for v in vertices {
                    parts.clear();
                    parts.extend(
                        corners.row(*v as usize).iter().map(|(face, slot)| triangulation.part(*face, *slot)),
                    );
                    let own = parts.len();
                    parts.extend_from_slice(extras.row(*v as usize));
                    let first = block.spokes.len();
                    let strung = chains.append(&parts, &mut block.spokes);
                    if let Some(mut before) = block.spokes[first..].last().copied() {
                        for spoke in &mut block.spokes[first..] {
                            spoke.set_late_ways(&before);
                            before = *spoke;
                        }
                    }
                    let is_one_ring = strung == Strung::Ring && !parts[own..].iter().any(Part::is_triangle);
                    let own = &parts[..own];
                    let angle = total_angle(own);
                    let is_cut = || !is_one_ring && is_cut(own);
                    block.bends.push(angle > TAU * STRAIGHT || (angle > PI * STRAIGHT && is_cut()));
                    block.counts.push((block.spokes.len() - first) as u32);
                }
                for spoke in &mut block.spokes {
                    spoke.end = rank[spoke.end as usize];
                }
                block
            })
            .collect();
        let mut spokes = Vec::with_capacity(blocks.iter().map(|block| block.spokes.len()).sum());
        let mut bends = Vec::with_capacity(order.len());
        let mut offsets = Vec::with_capacity(order.len() + 1);
        let mut next = 0;
        offsets.push(next);
        for block in &blocks {
            spokes.extend_from_slice(&block.spokes);
            bends.extend_from_slice(&block.bends);
            offsets.extend(block.counts.iter().map(|count| {
                next += count;
                next
            }));
        }
        let longest = spokes.iter().map(|spoke: &Spoke| spoke.length).fold(0.0, f64::max);
        Self { offsets, spokes, bends, order, rank, longest, band: BAND * mean_edge_length }
    }
}
