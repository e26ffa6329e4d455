//! The boundary between two answers about a distance.

/// The distance at which one answer becomes less likely than the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boundary {
    /// Where both are equally likely.
    pub at: f64,
    /// How fast the odds change: they are `(at / d)^steepness` for the nearer answer at distance `d`.
    pub steepness: f64,
}

impl Boundary {
    /// An answer is certain if it is at least this probable; below, a relation is called probable. A convention.
    pub const CERTAIN: f64 = 0.9;

    /// The probability of the nearer answer at a distance: 1 at distance 0, falling towards 0.
    #[must_use]
    pub fn probability(&self, distance: f64) -> f64 {
        1.0 / (1.0 + (distance / self.at).powf(self.steepness))
    }

    /// The distance at which the nearer answer has this probability.
    #[must_use]
    pub fn distance(&self, probability: f64) -> f64 {
        self.at * (1.0 / probability - 1.0).powf(1.0 / self.steepness)
    }

    /// The range of distances within which neither answer is [certain](Self::CERTAIN).
    #[must_use]
    pub fn gap(&self) -> [f64; 2] {
        [Self::CERTAIN, 1.0 - Self::CERTAIN].map(|probability| self.distance(probability))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_boundary_gives_the_probability_of_each_distance() {
        let boundary = Boundary { at: 2.0, steepness: 5.0 };
        assert_eq!(boundary.probability(0.0), 1.0);
        assert_eq!(boundary.probability(2.0), 0.5);
        assert_eq!(boundary.probability(f64::INFINITY), 0.0);
        for probability in [0.05, 0.5, 0.9] {
            assert!((boundary.probability(boundary.distance(probability)) - probability).abs() < 1e-12);
        }
        assert!(boundary.gap()[0] < 2.0 && boundary.gap()[1] > 2.0);
    }
}
