//! The boundary between two answers of a verdict.

/// A verdict is firm if it is at least this probable.
pub(crate) const FIRM: f64 = 0.9;

/// The combined distance at which one answer becomes less likely than the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boundary {
    /// Where both are equally likely.
    pub at: f64,
    /// How fast the odds change: they are `(at / d)^steepness` for the nearer answer at distance `d`.
    pub steepness: f64,
}

impl Boundary {
    /// The probability of the nearer answer at a combined distance: 1 at distance 0, falling towards 0.
    pub fn probability(&self, distance: f64) -> f64 {
        1.0 / (1.0 + (distance / self.at).powf(self.steepness))
    }

    /// The combined distance at which the nearer answer has this probability.
    pub fn distance(&self, probability: f64) -> f64 {
        self.at * (1.0 / probability - 1.0).powf(1.0 / self.steepness)
    }

    /// The range of distances within which neither answer is firm.
    pub(crate) fn gap(&self) -> [f64; 2] {
        [FIRM, 1.0 - FIRM].map(|probability| self.distance(probability))
    }
}
