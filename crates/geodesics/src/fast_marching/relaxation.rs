//! What the vertices of one round relax: edges, and triangles in lanes.

use super::one_ring::{Allowed, OneRings};
use super::update::{FAR, Stencil};
use crate::prefetch::prefetch;

/// Distances that differ by less than this share are equal up to rounding: a smaller improvement causes no visit, and
/// of two equal distances the smaller pseudo-source distance counts, in any order.
pub(super) const ROUNDING: f64 = 1e-13;

/// If shortest paths to the two ends of a base have different pseudo-sources, this share of the difference is added
/// to the smaller pseudo-source distance. The mean error over the reference meshes is least between 0.3 and 0.4,
/// where errors of either sign balance; `make bench-peers` measures them.
const LATER_PSEUDO_SOURCE: f64 = 0.35;

/// The tentative result at a vertex.
#[derive(Debug, Clone, Copy)]
pub(super) struct VertexLabel {
    /// Tentative distance from the source.
    pub(super) distance: f64,
    /// Distance of the pseudo-source: the vertex where the path to here last bent. Zero if the path is straight.
    pub(super) pseudo_source: f64,
}

impl VertexLabel {
    /// Of a vertex that has not been reached.
    pub(super) const UNREACHED: Self = Self { distance: f64::INFINITY, pseudo_source: 0.0 };
}

/// The state at the beginning of a round.
#[derive(Debug, Clone, Copy)]
pub(super) struct Round<'a> {
    pub(super) rings: &'a OneRings,
    pub(super) labels: &'a [VertexLabel],
    /// The vertices of the round.
    pub(super) vertices: &'a [u32],
    /// All vertices at smaller distances are finalized, and for each vertex those that are nearer than itself.
    pub(super) finalized: f64,
    /// Whether finalized vertices may still be corrected.
    pub(super) corrects: bool,
}

/// An edge that may lower its end.
#[derive(Debug, Clone, Copy)]
pub(super) struct EdgeRelaxation {
    pub(super) end: u32,
    pub(super) label: VertexLabel,
}

/// A triangle at a vertex of the round that may lower its third vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct TriangleUpdate {
    /// The vertex of the round.
    from: u32,
    /// The number of the neighbour that has the triangle.
    neighbour: u32,
    /// The number of the neighbour before.
    before: u32,
    /// 1 if `neighbour` is updated from `before`, 0 for the reverse.
    is_forward: u32,
}

/// A list that items are added to under a condition without a branch (stream compaction): a processor could not
/// predict which of many candidates are kept.
#[derive(Debug)]
struct Compaction<'a, T> {
    /// The items kept, and room for more.
    room: &'a mut [T],
    n: usize,
}

impl<'a, T: Copy> Compaction<'a, T> {
    /// An empty list for up to `most` items and one more. Allocates only to grow.
    fn new(room: &'a mut Vec<T>, most: usize, blank: T) -> Self {
        if room.len() <= most {
            room.resize((most + 1).next_power_of_two(), blank);
        }
        Self { room, n: 0 }
    }

    /// Adds an item if it `is_kept`.
    #[inline]
    fn add(&mut self, item: T, is_kept: bool) {
        self.room[self.n] = item;
        self.n += usize::from(is_kept);
    }

    /// The items kept.
    fn kept(self) -> &'a [T] {
        &self.room[..self.n]
    }
}

/// Room for the relaxations of a round, kept from round to round.
#[derive(Debug, Default)]
pub(super) struct Relaxations {
    edges: Vec<EdgeRelaxation>,
    triangles: Vec<TriangleUpdate>,
}

impl Relaxations {
    /// The edges and triangles that may lower a vertex, from all vertices of a round except where it `stops`.
    ///
    /// Of a triangle the farthest vertex is updated, if the other two are finalized. It may be finalized itself: then
    /// only if it can be reached before the vertex of the round.
    #[inline(never)]
    pub(super) fn find(
        &mut self,
        round: Round<'_>,
        stops: &impl Fn(u32, f64) -> bool,
    ) -> (&[EdgeRelaxation], &[TriangleUpdate]) {
        let Round { rings, labels, vertices, finalized, corrects } = round;
        let mut most = 0;
        for ring in vertices.iter().map(|vertex| rings.of(*vertex)) {
            prefetch(ring);
            most += ring.len();
        }
        let blank = EdgeRelaxation { end: 0, label: VertexLabel::UNREACHED };
        let mut edges = Compaction::new(&mut self.edges, most, blank);
        let mut triangles = Compaction::new(&mut self.triangles, 2 * most, TriangleUpdate::default());
        for &vertex in vertices {
            let VertexLabel { distance, pseudo_source } = labels[vertex as usize];
            if stops(vertex, distance) {
                continue;
            }
            let ring = rings.of(vertex);
            let Some(last) = ring.last() else { continue };
            let [first, end] = rings.range_of(vertex);
            let along_edges = if rings.may_bend(vertex) { distance } else { pseudo_source };
            let is_nearby = distance - pseudo_source <= (1.0 + FAR) * rings.longest;
            let allowed = Allowed::by_front(corrects, is_nearby);
            let finalized = finalized.max(distance);
            // Any triangle may lower vertices farther away than this, only late ones those that are nearer.
            let ahead_of = if corrects { distance } else { finalized };
            let (mut before, mut at_before) = (end - 1, labels[last.vertex as usize].distance);
            for (number, neighbour) in (first..).zip(ring) {
                let at_neighbour = labels[neighbour.vertex as usize].distance;
                let allowed = neighbour.allowed.only(allowed);
                let along = distance + neighbour.length;
                let label = VertexLabel { distance: along, pseudo_source: along_edges };
                let edge = EdgeRelaxation { end: neighbour.vertex, label };
                edges.add(edge, (along <= at_neighbour * (1.0 + ROUNDING)) & allowed.has(Allowed::EDGE));
                let is_forward = at_before < at_neighbour;
                // Not `min` and `max`, which check for NaN as well.
                let near = if at_before < at_neighbour { at_before } else { at_neighbour };
                let far = if at_before > at_neighbour { at_before } else { at_neighbour };
                let is_forward_bit = u32::from(is_forward);
                let triangle =
                    TriangleUpdate { from: vertex, neighbour: number, before, is_forward: is_forward_bit };
                triangles.add(triangle, (near <= finalized) & allowed.has_update(is_forward, far > ahead_of));
                (before, at_before) = (number, at_neighbour);
            }
            if corrects && finalized > distance {
                round.update_both_ways(vertex, finalized, &mut triangles);
            }
        }
        (edges.kept(), triangles.kept())
    }
}

impl Round<'_> {
    /// Adds the updates of the nearer of the two other vertices, for triangles at a vertex that was corrected: if
    /// both are finalized but farther away than the vertex.
    #[inline(never)]
    fn update_both_ways(&self, vertex: u32, finalized: f64, triangles: &mut Compaction<'_, TriangleUpdate>) {
        let distance = self.labels[vertex as usize].distance;
        let [first, end] = self.rings.range_of(vertex);
        let mut before = end - 1;
        for neighbour in first..end {
            let [at_before, at_neighbour] =
                [before, neighbour].map(|k| self.labels[self.rings.at(k).vertex as usize].distance);
            let are_behind = [at_before, at_neighbour].iter().all(|at| *at > distance && *at <= finalized);
            let is_forward = at_before >= at_neighbour;
            if are_behind && self.rings.at(neighbour).allowed.has_update(is_forward, true) {
                let is_forward = u32::from(is_forward);
                triangles.add(TriangleUpdate { from: vertex, neighbour, before, is_forward }, true);
            }
            before = neighbour;
        }
    }
}

/// Number of triangles solved together: a round has a dozen or two.
const LANES: usize = 4;

/// Triangles in lanes: each quantity of all of them side by side, as vector instructions need it.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    base: [f64; LANES],
    side: [f64; LANES],
    dot: [f64; LANES],
    cross: [f64; LANES],
    /// Distances and pseudo-source distances of the ends of the base.
    at_a: [f64; LANES],
    at_b: [f64; LANES],
    pseudo_source_a: [f64; LANES],
    pseudo_source_b: [f64; LANES],
    /// The same for the vertex that is updated.
    at_apex: [f64; LANES],
    pseudo_source: [f64; LANES],
    apex: [u32; LANES],
}

impl Block {
    #[inline]
    fn set(&mut self, lane: usize, triangle: &TriangleUpdate, rings: &OneRings, labels: &[VertexLabel]) {
        let (a, neighbour) = (labels[triangle.from as usize], rings.at(triangle.neighbour));
        let before = rings.at(triangle.before);
        let (base, side) = if triangle.is_forward == 1 { (before, neighbour) } else { (neighbour, before) };
        let b = labels[base.vertex as usize];
        (self.base[lane], self.side[lane]) = (base.length, side.length);
        (self.dot[lane], self.cross[lane]) = (neighbour.dot, neighbour.cross);
        (self.at_a[lane], self.pseudo_source_a[lane]) = (a.distance, a.pseudo_source);
        (self.at_b[lane], self.pseudo_source_b[lane]) = (b.distance, b.pseudo_source);
        self.apex[lane] = side.vertex;
    }

    /// Without branches, so that the same instructions solve all lanes.
    #[inline(always)]
    fn solve(&mut self, update: &impl Fn(Stencil, f64, f64) -> f64) {
        for i in 0..LANES {
            let (p, q) = (self.pseudo_source_a[i], self.pseudo_source_b[i]);
            // Not `min`, which checks for NaN as well.
            let smaller = if p < q { p } else { q };
            let pseudo_source = smaller + LATER_PSEUDO_SOURCE * (p - q).abs();
            let (base, side, dot, cross) = (self.base[i], self.side[i], self.dot[i], self.cross[i]);
            let stencil = Stencil { base, side, dot, cross };
            let [at_a, at_b] = [self.at_a[i] - pseudo_source, self.at_b[i] - pseudo_source];
            self.at_apex[i] = pseudo_source + update(stencil, at_a, at_b);
            self.pseudo_source[i] = pseudo_source;
        }
    }
}

/// Solves all triangles of a round.
#[derive(Debug, Default)]
pub(super) struct TriangleSolver {
    blocks: Vec<Block>,
    n: usize,
    instructions: pulp::Arch,
}

impl TriangleSolver {
    /// Solves `triangles`. All see the same labels, so their order does not matter.
    #[inline(never)]
    pub(super) fn solve(
        &mut self,
        triangles: &[TriangleUpdate],
        rings: &OneRings,
        labels: &[VertexLabel],
        update: &impl Fn(Stencil, f64, f64) -> f64,
    ) {
        self.n = triangles.len();
        let n_blocks = self.n.div_ceil(LANES);
        if self.blocks.len() < n_blocks {
            self.blocks.resize(n_blocks.next_power_of_two(), Block::default());
        }
        for (some, block) in triangles.chunks(LANES).zip(&mut self.blocks) {
            for (lane, triangle) in some.iter().enumerate() {
                block.set(lane, triangle, rings, labels);
            }
        }
        let blocks = &mut self.blocks[..n_blocks];
        self.instructions.dispatch(|| blocks.iter_mut().for_each(|block| block.solve(update)));
    }

    /// The vertices updated and their new labels; infinite where the triangle does not carry the front.
    pub(super) fn results(&self) -> impl Iterator<Item = (u32, VertexLabel)> {
        (0..self.n).map(|i| {
            let (block, lane) = (&self.blocks[i / LANES], i % LANES);
            let label =
                VertexLabel { distance: block.at_apex[lane], pseudo_source: block.pseudo_source[lane] };
            (block.apex[lane], label)
        })
    }
}
