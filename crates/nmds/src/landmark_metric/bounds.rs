//! Intervals of distances by the triangle inequality.

use linalg::LandmarkDistances;
use rayon::prelude::*;

use crate::NmdsError;
use crate::squares::check_extent;

/// A closed interval of distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// Its lower end, not negative.
    pub lower: f64,
    /// Its upper end.
    pub upper: f64,
}

impl Interval {
    /// The interval between two ends, in either order, without what is negative. Columns whose error is larger than stated
    /// can swap the ends.
    fn between(a: f64, b: f64) -> Self {
        Self { lower: a.min(b).max(0.0), upper: a.max(b).max(0.0) }
    }

    /// Whether a distance lies in it.
    #[must_use]
    pub fn contains(&self, distance: f64) -> bool {
        (self.lower..=self.upper).contains(&distance)
    }

    /// Its width.
    #[must_use]
    pub fn width(&self) -> f64 {
        self.upper - self.lower
    }
}

/// The error of computed distances: `computed - over <= true <= computed + under`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ColumnError {
    /// The most that a computed distance is too long, in the unit of the distances.
    pub over: f64,
    /// The most that it is too short.
    pub under: f64,
}

impl ColumnError {
    /// No error beyond rounding.
    pub const NONE: Self = Self { over: 0.0, under: 0.0 };
}

/// What the triangle inequality says about all pairs, from distances to landmarks in 16 bits each.
///
/// **Invariant.** If the stated errors hold and the true distances are a metric, the interval of a pair holds its distance:
/// intervals are rounded outwards by the rounding of the codes. Columns without error may be off by 1e-8 of the largest
/// distance.
#[derive(Debug, Clone, PartialEq)]
pub struct LandmarkBounds {
    parts: BoundsParts,
    n_points: usize,
}

/// What [`LandmarkBounds`] consist of.
#[derive(Debug, Clone, PartialEq)]
pub struct BoundsParts {
    /// Number of landmarks n.
    pub n_landmarks: usize,
    /// How many of them, the first, have columns without error.
    pub n_exact: usize,
    /// The error of the other columns.
    pub error: ColumnError,
    /// The distance that the codes count in, in the unit of the distances.
    pub quantum: f64,
    /// p x n distances, one row per point, in multiples of `quantum`.
    pub codes: Vec<u16>,
}

/// The most by which a distance differs from its code, in quanta: half for rounding, the rest for the rounding of exact
/// solvers, up to 1.5e-8 of the largest distance.
const HALF: f64 = 0.501;

/// The largest code.
const LARGEST: f64 = u16::MAX as f64;

impl LandmarkBounds {
    /// Stores the columns. The first `n_exact` have no error beyond rounding, the others that of `error`.
    ///
    /// # Errors
    /// [`NmdsError::NoExtent`] if all distances are zero; [`NmdsError::Linalg`].
    pub fn new(distances: &LandmarkDistances, n_exact: usize, error: ColumnError) -> Result<Self, NmdsError> {
        let (p, n) = (distances.n_points(), distances.n_landmarks());
        let quantum = check_extent(distances.max() / LARGEST, p)?;
        let mut codes = vec![0; p * n];
        let blocks = distances.blocks();
        let rows = blocks.first().map_or(1, |block| block.len().max(1));
        codes.par_chunks_mut(rows * n.max(1)).zip(&blocks).try_for_each(|(codes, block)| {
            let block = distances.rows(block.clone())?;
            for (point, codes) in codes.chunks_exact_mut(n).enumerate() {
                for (landmark, code) in codes.iter_mut().enumerate() {
                    // Conversion saturates.
                    *code = (block[(point, landmark)] / quantum).round() as u16;
                }
            }
            Ok::<_, NmdsError>(())
        })?;
        let parts = BoundsParts { n_landmarks: n, n_exact: n_exact.min(n), error, quantum, codes };
        Ok(Self { parts, n_points: p })
    }

    /// The bounds of stored parts; `None` if they do not fit together.
    #[must_use]
    pub fn of_parts(parts: BoundsParts) -> Option<Self> {
        let BoundsParts { n_landmarks, n_exact, error, quantum, ref codes } = parts;
        let is_length = |x: f64| x.is_finite() && x >= 0.0;
        let fits = n_landmarks > 0
            && n_exact <= n_landmarks
            && codes.len() % n_landmarks == 0
            && is_length(error.over)
            && is_length(error.under)
            && quantum > 0.0
            && (quantum * LARGEST).is_finite();
        let n_points = if fits { codes.len() / n_landmarks } else { 0 };
        fits.then_some(Self { n_points, parts })
    }

    /// What they consist of.
    #[must_use]
    pub fn parts(&self) -> &BoundsParts {
        &self.parts
    }

    /// Number of points p.
    #[must_use]
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// The stored distance of a point from its nearest landmark, in quanta.
    pub(super) fn nearest(&self, point: usize) -> u16 {
        self.row(point).iter().copied().min().unwrap_or(0)
    }

    fn row(&self, point: usize) -> &[u16] {
        &self.parts.codes[point * self.parts.n_landmarks..][..self.parts.n_landmarks]
    }

    /// The interval that holds the distance of two points, in the unit of the distances.
    ///
    /// # Panics
    /// If there is no such point.
    #[must_use]
    pub fn interval(&self, a: usize, b: usize) -> Interval {
        self.of(a, b).1
    }

    /// What the landmarks leave open if no column has an error, and the interval that holds the distance in any case.
    pub(super) fn of(&self, a: usize, b: usize) -> (Interval, Interval) {
        if a == b {
            let zero = Interval { lower: 0.0, upper: 0.0 };
            return (zero, zero);
        }
        let BoundsParts { n_landmarks, n_exact, error, quantum, .. } = self.parts;
        let (a, b) = (self.row(a), self.row(b));
        let ends = |(difference, sum): (u32, u32)| {
            [f64::from(difference) - 2.0 * HALF, f64::from(sum) + 2.0 * HALF].map(|code| code * quantum)
        };
        if n_exact == n_landmarks {
            let [lower, upper] = ends(extremes(a, b));
            let interval = Interval::between(lower, upper);
            return (interval, interval);
        }
        let [mut lower, mut upper] = ends(extremes(&a[n_exact..], &b[n_exact..]));
        let mut widened = [lower - error.over - error.under, upper + 2.0 * error.under];
        if n_exact > 0 {
            let [sure_lower, sure_upper] = ends(extremes(&a[..n_exact], &b[..n_exact]));
            widened = [widened[0].max(sure_lower), widened[1].min(sure_upper)];
            (lower, upper) = (lower.max(sure_lower), upper.min(sure_upper));
        }
        let open = Interval::between(lower, upper);
        let held = Interval::between(widened[0], widened[1]);
        // Only rounding and wrong statements of the error let the open interval exceed the other.
        (open, Interval { lower: held.lower.min(open.lower), upper: held.upper.max(open.upper) })
    }
}

/// The largest difference and the smallest sum of the entries of two rows.
#[inline]
fn extremes(a: &[u16], b: &[u16]) -> (u32, u32) {
    let (mut difference, mut sum) = (0u16, u16::MAX);
    for (x, y) in a.iter().zip(b) {
        difference = difference.max(x.abs_diff(*y));
        sum = sum.min(x.saturating_add(*y));
    }
    let sum = match sum {
        // Perhaps the smallest sum, perhaps less than it.
        u16::MAX => a.iter().zip(b).map(|(x, y)| u32::from(*x) + u32::from(*y)).min().unwrap_or(0),
        sum => sum.into(),
    };
    (difference.into(), sum)
}

#[cfg(test)]
mod tests {
    use linalg::Matrix;

    use super::*;
    use crate::tests::support::{Cloud, landmark_distances};

    #[test]
    fn sums_beyond_sixteen_bits_are_not_cut_off() {
        assert_eq!(extremes(&[65535, 65000], &[65535, 64000]), (1000, 129_000));
        assert_eq!(extremes(&[65535, 10], &[0, 7]), (65535, 17));
    }

    #[test]
    fn intervals_hold_every_distance_up_to_their_rounding() {
        let cloud = Cloud::new(300, 3, 4);
        let bounds = LandmarkBounds::new(&landmark_distances(&cloud, 9), 9, ColumnError::NONE).unwrap();
        let mut widest = 0.0f64;
        for i in 0..300 {
            for j in 0..300 {
                let interval = bounds.interval(i, j);
                assert!(interval.contains(cloud.distance(i, j)), "{i} {j}");
                // From a landmark, only rounding is left.
                if i < 9 && i != j {
                    widest = widest.max(interval.width());
                }
            }
        }
        assert!(widest <= 2.1 * bounds.parts().quantum);
    }

    /// Points of a line, with distances that are wrong by up to `over` and `under`.
    #[test]
    fn stated_errors_widen_the_interval_as_far_as_they_can_reach() {
        let (over, under) = (0.3, 0.2);
        let wrong = |i: usize, j: usize| match (i + j) % 3 {
            _ if i == j => 0.0,
            0 => i.abs_diff(j) as f64 + over,
            1 => i.abs_diff(j) as f64 - under,
            _ => i.abs_diff(j) as f64,
        };
        let landmarks = vec![0, 7, 13, 19];
        let columns = Matrix::from_fn(20, 4, |i, j| wrong(i, landmarks[j]));
        let distances = LandmarkDistances::new(landmarks, columns).unwrap();
        let hold = |error| {
            let bounds = LandmarkBounds::new(&distances, 0, error).unwrap();
            let pairs = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
            pairs.filter(|&(i, j)| bounds.interval(i, j).contains(i.abs_diff(j) as f64)).count()
        };
        assert_eq!(hold(ColumnError { over, under }), 400);
        assert!(hold(ColumnError::NONE) < 400, "columns that are wrong do not bound the distances");
    }

    #[test]
    fn exact_columns_are_not_widened_beside_others() {
        let cloud = Cloud::new(60, 2, 8);
        let distances = landmark_distances(&cloud, 6);
        let error = ColumnError { over: 0.4, under: 0.4 };
        let some = LandmarkBounds::new(&distances, 2, error).unwrap();
        let all = LandmarkBounds::new(&distances, 6, error).unwrap();
        let none = LandmarkBounds::new(&distances, 0, error).unwrap();
        for (i, j) in (0..60).map(|i| (i, (11 * i + 5) % 60)) {
            let [all, some, none] = [&all, &some, &none].map(|bounds| bounds.interval(i, j));
            assert!(all.lower >= some.lower && some.lower >= none.lower && none.lower >= 0.0);
            assert!(all.upper <= some.upper && some.upper <= none.upper);
        }
        assert!(some.interval(0, 30).width() < 2.1 * some.parts().quantum);
    }

    #[test]
    fn parts_that_do_not_fit_together_are_refused() {
        let whole = LandmarkBounds::new(&landmark_distances(&Cloud::new(10, 2, 1), 3), 3, ColumnError::NONE);
        let parts = whole.unwrap().parts().clone();
        assert!(LandmarkBounds::of_parts(parts.clone()).is_some());
        for broken in [
            BoundsParts { n_landmarks: 0, ..parts.clone() },
            BoundsParts { n_landmarks: 4, ..parts.clone() },
            BoundsParts { n_exact: 4, ..parts.clone() },
            BoundsParts { quantum: 0.0, ..parts.clone() },
            BoundsParts { quantum: f64::NAN, ..parts.clone() },
            BoundsParts { quantum: f64::MAX, ..parts.clone() },
            BoundsParts { error: ColumnError { over: -1.0, under: 0.0 }, ..parts.clone() },
            BoundsParts { error: ColumnError { over: 0.0, under: f64::INFINITY }, ..parts },
        ] {
            assert_eq!(LandmarkBounds::of_parts(broken), None);
        }
    }
}
