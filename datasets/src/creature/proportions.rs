//! The random choices that make one family of a body plan different from the next.

use crate::stream::{Purpose, Stream};

/// Random lengths, girths and counts.
///
/// The range of every number is divided into two halves, and two families that follow each other on the same plan draw
/// it from different halves. So they differ in all proportions, whatever the seed is.
pub(crate) struct Proportions {
    /// Also for everything else.
    pub(crate) stream: Stream,
    /// Draws that all families of a plan have in common.
    shared: Stream,
    /// Number of families of the plan before this one.
    round: usize,
    n_drawn: usize,
}

impl Proportions {
    /// The proportions of one family of a plan, and others for another `attempt`.
    pub(crate) fn new(seed: u64, plan: usize, round: usize, attempt: usize) -> Self {
        let stream = Stream::of_creature(seed, plan, 1 + round * 64 + attempt, Purpose::Build);
        let shared = Stream::of_creature(seed, plan, 0, Purpose::Build);
        Self { stream, shared, round, n_drawn: 0 }
    }

    /// A number in `[lo, hi)`.
    pub(crate) fn between(&mut self, lo: f64, hi: f64) -> f64 {
        let half = (self.n_drawn + self.round) % 2;
        self.n_drawn += 1;
        lo + (hi - lo) * 0.5 * (half as f64 + self.stream.uniform(0.0, 1.0))
    }

    /// A number in `lo..=hi`; families that follow each other have different ones.
    pub(crate) fn count(&mut self, lo: usize, hi: usize) -> usize {
        let n = hi - lo + 1;
        lo + (self.shared.below(n) + self.round) % n
    }
}
