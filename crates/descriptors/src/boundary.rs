//! The boundary between two answers about a distance.

/// A distance, or a probability, whether the nearer answer is right, and how much that counts.
pub type Sample = (f64, bool, f64);

/// Steps of a fit, after which no printed digit changes any more.
const STEPS: usize = 100;

/// The distance at which one answer becomes less likely than the other.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Boundary {
    /// Where both are equally likely.
    pub at: f64,
    /// How fast the odds change: by default, they are `(at / d)^steepness` for the nearer answer at distance `d`.
    pub steepness: f64,
    /// Probabilities of the nearer answer infinitely far away, below ½, and at distance 0, above ½.
    pub range: [f64; 2],
}

impl Boundary {
    /// An answer is certain if it is at least this probable; below, a relation is called probable. A convention.
    pub const CERTAIN: f64 = 0.9;

    /// A boundary on either side of which any probability is reached.
    pub const fn new(at: f64, steepness: f64) -> Self {
        Self { at, steepness, range: [0.0, 1.0] }
    }

    /// The boundary of greatest likelihood, by expectation maximization: a logarithm of the distance is on the near or the far side, by
    /// logistic regression, and on each side a share of pairs is one. The iteration starts from the range of these shares; 0 and 1
    /// stay, and leave a plain logistic regression.
    pub fn fitted(samples: &[Sample], [mut far, mut near]: [f64; 2]) -> Self {
        let [mut a, mut b] = [0.0, -1.0];
        for _ in 0..STEPS {
            let (mut gradient, mut hessian, mut sides) = ([0.0; 2], [0.0; 3], [[0.0; 2]; 2]);
            for &(distance, is_one, weight) in samples {
                let x = distance.ln();
                // Near the ends, one of both is not 1 less the other.
                let [p, q] = [-a - b * x, a + b * x].map(|odds| 1.0 / (1.0 + odds.exp()));
                let kind = usize::from(is_one);
                let [at_far, at_near] = [[1.0 - far, far], [1.0 - near, near]].map(|share| share[kind]);
                let is_near = at_near * p / (at_near * p + at_far * q);
                sides[0][kind] += weight * (1.0 - is_near);
                sides[1][kind] += weight * is_near;
                let rest = weight * (is_near - p);
                gradient = [gradient[0] + rest, gradient[1] + rest * x];
                let spread = weight * p * q;
                hessian = [hessian[0] + spread, hessian[1] + spread * x, hessian[2] + spread * x * x];
            }
            let determinant = hessian[0] * hessian[2] - hessian[1] * hessian[1];
            let step = [
                (hessian[2] * gradient[0] - hessian[1] * gradient[1]) / determinant,
                (hessian[0] * gradient[1] - hessian[1] * gradient[0]) / determinant,
            ];
            // Far from the greatest likelihood, Newton's steps are too long.
            let length = step[0].hypot(step[1]).max(1.0);
            (a, b) = (a + step[0] / length, b + step[1] / length);
            [far, near] = sides.map(|[others, these]| these / (others + these));
        }
        let at = ((a - ((0.5 - far) / (near - 0.5)).ln()) / -b).exp();
        Self { at, steepness: -b, range: [far, near] }
    }

    /// The probability of the nearer answer at a distance. It falls from one end of the range to the other.
    pub fn probability(&self, distance: f64) -> f64 {
        let [far, near] = self.range;
        let odds = (distance / self.at).powf(self.steepness) * (near - 0.5) / (0.5 - far);
        far + (near - far) / (1.0 + odds)
    }

    /// The distance at which the nearer answer has this probability: 0 or infinite if that is beyond the range.
    pub fn distance(&self, probability: f64) -> f64 {
        let [far, near] = self.range;
        let odds = (near - probability).max(0.0) / (probability - far).max(0.0);
        self.at * (odds * (0.5 - far) / (near - 0.5)).powf(1.0 / self.steepness)
    }

    /// The range of distances within which neither answer is [certain](Self::CERTAIN).
    pub fn gap(&self) -> [f64; 2] {
        [Self::CERTAIN, 1.0 - Self::CERTAIN].map(|probability| self.distance(probability))
    }
}
