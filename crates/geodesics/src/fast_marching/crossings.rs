//! The triangles that the front crosses in one round, solved side by side.

use super::spokes::Spokes;
use super::update::Sector;

/// Where the ways to the two ends of a base bent at different distances, this share of the difference
/// is added to the lesser: the mean error over the reference meshes is least between 0.3 and 0.4, where
/// errors of either sign balance.
const LATER_BEND: f64 = 0.35;

/// How far a vertex is from the source, and where the way to it last bent.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reached {
    pub(super) distance: f64,
    /// The distance from the source at which the way last bent around a vertex; zero for a straight one.
    pub(super) bend: f64,
}

impl Reached {
    pub(super) const NEVER: Self = Self { distance: f64::INFINITY, bend: 0.0 };
}

/// A triangle that the front crosses when it leaves a vertex.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Crossing {
    /// The vertex.
    pub(super) from: u32,
    /// The spoke of the vertex that has the triangle behind it.
    pub(super) spoke: u32,
    /// The spoke before that one.
    pub(super) before: u32,
    /// 1 if the front goes on to the end of `spoke`, 0 if it goes back to the end of `before`.
    pub(super) is_onward: u32,
}

/// How many triangles are solved together: a round has a dozen or two.
const LANES: usize = 4;

/// Triangles, each quantity of all of them side by side, as vector instructions need it.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    base: [f64; LANES],
    side: [f64; LANES],
    dot: [f64; LANES],
    cross: [f64; LANES],
    /// Distances of the ends of the base, and where the ways to them bent.
    at_a: [f64; LANES],
    at_b: [f64; LANES],
    bend_a: [f64; LANES],
    bend_b: [f64; LANES],
    /// The same for the vertex across the base.
    at_apex: [f64; LANES],
    bend: [f64; LANES],
    apex: [u32; LANES],
}

impl Block {
    #[inline]
    fn set(&mut self, lane: usize, crossing: &Crossing, spokes: &Spokes, reached: &[Reached]) {
        let (a, spoke) = (reached[crossing.from as usize], spokes.at(crossing.spoke));
        let before = spokes.at(crossing.before);
        let (base, side) = if crossing.is_onward == 1 { (before, spoke) } else { (spoke, before) };
        let b = reached[base.end as usize];
        (self.base[lane], self.side[lane]) = (base.length, side.length);
        (self.dot[lane], self.cross[lane]) = (spoke.dot, spoke.cross);
        (self.at_a[lane], self.bend_a[lane]) = (a.distance, a.bend);
        (self.at_b[lane], self.bend_b[lane]) = (b.distance, b.bend);
        self.apex[lane] = side.end;
    }

    /// Without branches, so that all lanes are solved by the same instructions.
    #[inline]
    fn solve(&mut self, update: &impl Fn(Sector, f64, f64) -> f64) {
        for i in 0..LANES {
            let (p, q) = (self.bend_a[i], self.bend_b[i]);
            // Not `min`, which looks for NaN as well.
            let earlier = if p < q { p } else { q };
            let bend = earlier + LATER_BEND * (p - q).abs();
            let (base, side, dot, cross) = (self.base[i], self.side[i], self.dot[i], self.cross[i]);
            let sector = Sector { base, side, dot, cross };
            self.at_apex[i] = bend + update(sector, self.at_a[i] - bend, self.at_b[i] - bend);
            self.bend[i] = bend;
        }
    }
}

/// Solves all triangles of a round.
#[derive(Debug, Default)]
pub(super) struct CrossingSolver {
    blocks: Vec<Block>,
    n: usize,
}

impl CrossingSolver {
    /// Solves `crossings`. All see the same `reached`, so their order is of no account.
    #[inline(never)]
    pub(super) fn solve(
        &mut self,
        crossings: &[Crossing],
        spokes: &Spokes,
        reached: &[Reached],
        update: &impl Fn(Sector, f64, f64) -> f64,
    ) {
        self.n = crossings.len();
        let n_blocks = self.n.div_ceil(LANES);
        if self.blocks.len() < n_blocks {
            self.blocks.resize(n_blocks.next_power_of_two(), Block::default());
        }
        for (some, block) in crossings.chunks(LANES).zip(&mut self.blocks) {
            for (lane, crossing) in some.iter().enumerate() {
                block.set(lane, crossing, spokes, reached);
            }
            block.solve(update);
        }
    }

    /// The vertices across the triangles and what the front found for them; infinite where a triangle does
    /// not carry it.
    pub(super) fn found(&self) -> impl Iterator<Item = (u32, Reached)> {
        (0..self.n).map(|i| {
            let (block, lane) = (&self.blocks[i / LANES], i % LANES);
            (block.apex[lane], Reached { distance: block.at_apex[lane], bend: block.bend[lane] })
        })
    }
}
