//! What the columns of landmarks say about all pairs: an interval and an estimate.

use linalg::LandmarkDistances;
use nmds::{NmdsError, low_rank_factor};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// A closed interval of distances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    /// Its lower end, not negative.
    pub(crate) lower: f64,
    pub(crate) upper: f64,
}

impl Interval {
    /// The interval between two ends, in either order, without what is negative. Columns whose error is larger than stated
    /// can swap the ends.
    fn between(a: f64, b: f64) -> Self {
        Self { lower: a.min(b).max(0.0), upper: a.max(b).max(0.0) }
    }

    pub(crate) fn width(&self) -> f64 {
        self.upper - self.lower
    }
}

/// The error of computed distances: `computed - over <= true <= computed + under`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct ColumnError {
    /// The most that a computed distance is too long, in the unit of the distances.
    pub(crate) over: f64,
    /// The most that it is too short.
    pub(crate) under: f64,
}

impl ColumnError {
    /// No error beyond rounding.
    pub(crate) const NONE: Self = Self { over: 0.0, under: 0.0 };
}

/// Distances of all points from n landmarks and a factor of all squared distances, in 16 bits each.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Tables {
    /// Number of landmarks n.
    pub(crate) n_landmarks: usize,
    /// How many of them, the first, have columns without error.
    pub(crate) n_exact: usize,
    /// The error of the other columns.
    pub(crate) error: ColumnError,
    /// The distance that the codes count in, in the unit of the distances.
    pub(crate) quantum: f64,
    /// p x n distances, one row per point, in multiples of `quantum`.
    #[serde(skip)]
    pub(crate) codes: Vec<u16>,
    /// Number of eigenpairs behind the factor.
    pub(crate) rank: usize,
    /// How many of them, the first, have positive eigenvalues.
    pub(crate) n_positive: usize,
    /// What the entries of the factor count in, in the unit of the distances.
    pub(crate) factor_quantum: f64,
    /// `Z`, p x rank, one row per point, in multiples of `factor_quantum`.
    #[serde(skip)]
    pub(crate) factor: Vec<i16>,
}

/// What the distances to n landmarks say about the distance of any two of p points: an interval that holds it, and an
/// estimate in the interval.
///
/// * **Interval**: `max |F_xi - F_yi| <= d(x, y) <= min (F_xi + F_yi)` over the landmarks i, widened by the rounding of the codes and
///   by the [`ColumnError`]. If the stated errors hold and the true distances are a metric, it holds the distance. Columns without
///   error may be off by 1e-8 of the largest distance.
/// * **Estimate**: the Nystrom approximation of the squared distances ([`low_rank_factor`]), limited to the interval. The
///   approximation of `d(x, x)² = 0` is not zero. Half the sum of its values at `(x, x)` and `(y, y)` is subtracted where
///   x and y are near each other, compared with their distances to the landmarks next to them. One unit for all entries of the factor
///   costs nothing, because the largest entries dominate the error of a product.
/// * Symmetric, and zero for equal points.
/// * Memory: `2 n + 2 rank + 8` bytes per point. Cost: `O(n + rank)` for a pair, which reads two short rows.
///
/// The interval is that of landmark searches on graphs (Goldberg and Harrelson 2005, `goldberg2005` in `REFERENCES.bib`).
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LandmarkMetric {
    tables: Tables,
    /// For every point, the distance to the nearest landmark and the approximation of its squared distance from itself, in
    /// the quanta of the distances and the squared quanta of the factor.
    local: Vec<[f32; 2]>,
}

/// What is known about the distance of two points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct PairEstimate {
    /// The estimate, in `bounds`.
    pub(crate) distance: f64,
    /// The interval that holds the distance.
    pub(crate) bounds: Interval,
    /// What the landmarks leave open if the columns have no error: part of `bounds`. Its width says how well the landmarks
    /// know the pair.
    pub(crate) open: Interval,
}

/// The distance, in distances to the nearest landmarks, beyond which the value at equal points says nothing. Measured on
/// two scans; twice or half as much changes the mean error by less than a tenth.
const REACH: f64 = 2.0;

/// The most by which a distance differs from its code, in quanta: half for rounding, the rest for the rounding of exact
/// solvers, up to 1.5e-8 of the largest distance.
const HALF: f64 = 0.501;

/// The largest code.
const LARGEST: f64 = u16::MAX as f64;

/// Numbers that are added up side by side.
const LANES: usize = 8;

impl LandmarkMetric {
    /// Takes the columns. The first `n_exact` have no error beyond rounding, the others that of `error`. `rank` eigenpairs make the
    /// estimate, those of largest magnitude.
    ///
    /// # Errors
    /// [`NmdsError::BadRank`], [`NmdsError::NoExtent`], [`NmdsError::Linalg`].
    pub(crate) fn new(
        distances: &LandmarkDistances,
        n_exact: usize,
        error: ColumnError,
        rank: usize,
    ) -> Result<Self, NmdsError> {
        let (p, n) = (distances.n_points(), distances.n_landmarks());
        let (z, n_positive) = low_rank_factor(distances, rank)?;
        let (rank, factor_quantum) = (z.ncols(), z.amax() / f64::from(i16::MAX));
        let mut factor = vec![0; p * rank];
        if factor_quantum > 0.0 {
            factor.par_chunks_mut(rank).enumerate().for_each(|(point, row)| {
                let values = z.row(point);
                for (code, value) in row.iter_mut().zip(values.iter()) {
                    *code = (value / factor_quantum).round() as i16;
                }
            });
        }
        drop(z);
        let quantum = distances.max() / LARGEST;
        let (mut codes, blocks) = (vec![0; p * n], distances.blocks());
        let height = blocks.first().map_or(1, |block| block.len().max(1));
        codes.par_chunks_mut(height * n).zip(blocks).try_for_each(|(codes, block)| {
            let block = distances.rows(block)?;
            for (row, distances) in codes.chunks_exact_mut(n).zip(block.row_iter()) {
                for (code, d) in row.iter_mut().zip(distances.iter()) {
                    // Conversion saturates.
                    *code = (d / quantum).round() as u16;
                }
            }
            Ok::<_, NmdsError>(())
        })?;
        let (n_landmarks, n_exact) = (n, n_exact.min(n));
        Ok(Self::with_local(Tables {
            n_landmarks,
            n_exact,
            error,
            quantum,
            codes,
            rank,
            n_positive,
            factor_quantum,
            factor,
        }))
    }

    /// The metric of stored tables; `None` if they do not fit together.
    pub(crate) fn of(tables: Tables) -> Option<Self> {
        let Tables { n_landmarks: n, n_exact, error, quantum, rank, n_positive, factor_quantum, .. } = tables;
        let is_length = |x: f64| x.is_finite() && x >= 0.0;
        let fits = n > 0
            && n_exact <= n
            && rank > 0
            && n_positive <= rank
            && tables.codes.len().is_multiple_of(n)
            && tables.factor.len().is_multiple_of(rank)
            && tables.codes.len() / n == tables.factor.len() / rank
            && [error.over, error.under, factor_quantum].into_iter().all(is_length)
            && quantum > 0.0
            && (quantum * LARGEST).is_finite();
        fits.then(|| Self::with_local(tables))
    }

    fn with_local(tables: Tables) -> Self {
        let mut metric = Self { tables, local: Vec::new() };
        let local = |point: usize| {
            let nearest = metric.row(point).iter().copied().min().unwrap_or(0);
            [f32::from(nearest), metric.product(point, point) as f32]
        };
        metric.local = (0..metric.tables.codes.len() / metric.tables.n_landmarks.max(1)).map(local).collect();
        metric
    }

    /// What it is made of.
    pub(crate) fn tables(&self) -> &Tables {
        &self.tables
    }

    /// The largest distance of a point from its nearest landmark, in the unit of the distances.
    pub(crate) fn covering_radius(&self) -> f64 {
        let codes = self.local.iter().fold(0f32, |most, [nearest, _]| most.max(*nearest));
        f64::from(codes) * self.tables.quantum
    }

    /// What is known about the distance of two points, in the unit of the distances.
    pub(crate) fn pair(&self, a: usize, b: usize) -> PairEstimate {
        let (open, bounds) = self.intervals(a, b);
        let [[near_a, own_a], [near_b, own_b]] =
            [self.local[a], self.local[b]].map(|local| local.map(f64::from));
        let mut square = self.product(a, b);
        let reach = REACH * (near_a + near_b) * self.tables.quantum;
        if reach > 0.0 {
            let far = open.lower / reach * (open.upper / reach);
            square -= 0.5 * (own_a + own_b) * (-far).exp();
        }
        let distance = square.max(0.0).sqrt() * self.tables.factor_quantum;
        let distance = distance.max(open.lower).min(open.upper);
        PairEstimate { distance, bounds, open }
    }

    /// What the landmarks leave open if no column has an error, and the interval that holds the distance in any case.
    pub(crate) fn intervals(&self, a: usize, b: usize) -> (Interval, Interval) {
        if a == b {
            let zero = Interval { lower: 0.0, upper: 0.0 };
            return (zero, zero);
        }
        let Tables { n_landmarks, n_exact, error, quantum, .. } = self.tables;
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

    fn row(&self, point: usize) -> &[u16] {
        let n = self.tables.n_landmarks;
        &self.tables.codes[point * n..][..n]
    }

    /// The approximation of a squared distance, in squared quanta of the factor; it may be negative.
    #[inline]
    fn product(&self, a: usize, b: usize) -> f64 {
        let Tables { rank, n_positive, ref factor, .. } = self.tables;
        let row = |point: usize| factor[point * rank..][..rank].split_at(n_positive);
        let ((positive_a, negative_a), (positive_b, negative_b)) = (row(a), row(b));
        dot(positive_a, positive_b) - dot(negative_a, negative_b)
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

/// The scalar product of two rows. Every product of two codes has 31 bits, so lanes of 32-bit floats lose a share of 6e-8 of
/// the largest term.
#[inline]
fn dot(a: &[i16], b: &[i16]) -> f64 {
    let mut sums = [0f32; LANES];
    let (blocks, rest) = a.as_chunks::<LANES>();
    let (other, other_rest) = b.as_chunks::<LANES>();
    for (a, b) in blocks.iter().zip(other) {
        for lane in 0..LANES {
            sums[lane] += f32::from(a[lane]) * f32::from(b[lane]);
        }
    }
    let rest: f64 = rest.iter().zip(other_rest).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum();
    sums.iter().map(|sum| f64::from(*sum)).sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use linalg::Matrix;

    use super::*;

    /// Points of a box with sides of different lengths.
    struct Cloud(Vec<Vec<f64>>);

    impl Cloud {
        fn new(p: usize, dim: usize) -> Self {
            let at = |i: usize, k: usize| {
                let wave = ((1 + i) as f64 * 12.9898 + (1 + k) as f64 * 78.233).sin() * 43758.5453;
                (wave - wave.floor()) * 10.0 / (k + 1) as f64
            };
            Self((0..p).map(|i| (0..dim).map(|k| at(i, k)).collect()).collect())
        }

        fn distance(&self, i: usize, j: usize) -> f64 {
            linalg::sq_distance(&self.0[i], &self.0[j]).sqrt()
        }

        /// Distances from the first `n` points, in another unit.
        fn landmarks(&self, n: usize, unit: f64) -> LandmarkDistances {
            let columns = Matrix::from_fn(self.0.len(), n, |i, j| unit * self.distance(i, j));
            LandmarkDistances::new((0..n).collect(), columns).unwrap()
        }
    }

    fn metric(distances: &LandmarkDistances, rank: usize) -> LandmarkMetric {
        LandmarkMetric::new(distances, distances.n_landmarks(), ColumnError::NONE, rank).unwrap()
    }

    fn contains(interval: Interval, distance: f64) -> bool {
        (interval.lower..=interval.upper).contains(&distance)
    }

    #[test]
    fn sums_beyond_sixteen_bits_are_not_cut_off() {
        assert_eq!(extremes(&[65535, 65000], &[65535, 64000]), (1000, 129_000));
        assert_eq!(extremes(&[65535, 10], &[0, 7]), (65535, 17));
    }

    #[test]
    fn the_product_equals_the_sum_of_products() {
        let wave = |i: usize, k: usize| ((((i * k) as f64).sin()) * 32767.0) as i16;
        for n in [0, 1, 7, 8, 9, 50] {
            let (a, b): (Vec<i16>, Vec<i16>) = (0..n).map(|i| (wave(i, 3), wave(i, 5))).unzip();
            let expected: i64 = a.iter().zip(&b).map(|(a, b)| i64::from(*a) * i64::from(*b)).sum();
            assert!((dot(&a, &b) - expected as f64).abs() < 1e-6 * 32767f64.powi(2), "{n}");
        }
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
            let metric = LandmarkMetric::new(&distances, 0, error, 2).unwrap();
            let pairs = (0..20).flat_map(|i| (0..20).map(move |j| (i, j)));
            pairs.filter(|&(i, j)| contains(metric.intervals(i, j).1, i.abs_diff(j) as f64)).count()
        };
        assert_eq!(hold(ColumnError { over, under }), 400);
        assert!(hold(ColumnError::NONE) < 400, "columns that are wrong do not bound the distances");
    }

    #[test]
    fn exact_columns_are_not_widened_beside_others() {
        let distances = Cloud::new(60, 2).landmarks(6, 1.0);
        let error = ColumnError { over: 0.4, under: 0.4 };
        let [all, some, none] = [6, 2, 0].map(|n| LandmarkMetric::new(&distances, n, error, 3).unwrap());
        for (i, j) in (0..60).map(|i| (i, (11 * i + 5) % 60)) {
            let [all, some, none] = [&all, &some, &none].map(|metric| metric.intervals(i, j).1);
            assert!(all.lower >= some.lower && some.lower >= none.lower && none.lower >= 0.0);
            assert!(all.upper <= some.upper && some.upper <= none.upper);
        }
        assert!(some.intervals(0, 30).1.width() < 2.1 * some.tables.quantum);
    }

    #[test]
    fn points_in_space_are_estimated_exactly_and_lie_in_their_intervals() {
        let cloud = Cloud::new(200, 3);
        let metric = metric(&cloud.landmarks(12, 1.0), 5);
        let extent = (0..200).map(|i| cloud.distance(0, i)).fold(0.0, f64::max);
        for i in 0..200 {
            for j in 0..200 {
                let (pair, expected) = (metric.pair(i, j), cloud.distance(i, j));
                assert_eq!(pair, metric.pair(j, i));
                assert!(contains(pair.bounds, expected) && contains(pair.bounds, pair.distance), "{i} {j}");
                // Squares are stored with an error of 3e-5 of the largest.
                assert!((pair.distance.powi(2) - expected.powi(2)).abs() < 3e-4 * extent.powi(2), "{i} {j}");
                // From a landmark, only rounding is left.
                let width = metric.intervals(i, j).1.width();
                assert!(i >= 12 || i == j || width <= 2.1 * metric.tables.quantum, "{i} {j}: {width}");
            }
            assert_eq!(metric.pair(i, i).bounds, Interval { lower: 0.0, upper: 0.0 });
        }
    }

    #[test]
    fn another_unit_changes_nothing_but_the_unit() {
        let cloud = Cloud::new(150, 4);
        let plain = metric(&cloud.landmarks(20, 1.0), 10);
        for scale in [2f64.powi(-40), 2f64.powi(60)] {
            let other = metric(&cloud.landmarks(20, scale), 10);
            for (i, j) in (0..150).map(|i| (i, (7 * i + 3) % 150)) {
                let (a, b) = (plain.pair(i, j), other.pair(i, j));
                let scaled = [a.bounds.lower, a.bounds.upper].map(|d| d * scale);
                assert_eq!(scaled, [b.bounds.lower, b.bounds.upper]);
                assert!((a.distance * scale - b.distance).abs() <= 1e-6 * b.distance, "{i} {j}");
            }
        }
    }

    #[test]
    fn impossible_ranks_and_points_without_extent_are_refused() {
        let distances = Cloud::new(30, 2).landmarks(5, 1.0);
        for rank in [0, 6] {
            let fault = LandmarkMetric::new(&distances, 5, ColumnError::NONE, rank).unwrap_err();
            assert_eq!(fault, NmdsError::BadRank { rank, n_landmarks: 5 });
        }
        let zero = LandmarkDistances::new(vec![0], Matrix::zeros(3, 1)).unwrap();
        let fault = LandmarkMetric::new(&zero, 1, ColumnError::NONE, 1).unwrap_err();
        assert_eq!(fault, NmdsError::NoExtent(3));
    }

    #[test]
    fn tables_that_do_not_fit_together_are_refused() {
        let whole = metric(&Cloud::new(10, 2).landmarks(5, 1.0), 3);
        let tables = whole.tables.clone();
        assert_eq!(LandmarkMetric::of(tables.clone()), Some(whole));
        for broken in [
            Tables { n_landmarks: 0, ..tables.clone() },
            Tables { n_landmarks: 4, ..tables.clone() },
            Tables { n_landmarks: 10, ..tables.clone() },
            Tables { n_exact: 6, ..tables.clone() },
            Tables { quantum: 0.0, ..tables.clone() },
            Tables { quantum: f64::NAN, ..tables.clone() },
            Tables { quantum: f64::MAX, ..tables.clone() },
            Tables { error: ColumnError { over: -1.0, under: 0.0 }, ..tables.clone() },
            Tables { error: ColumnError { over: 0.0, under: f64::INFINITY }, ..tables.clone() },
            Tables { rank: 0, ..tables.clone() },
            Tables { rank: 4, ..tables.clone() },
            Tables { n_positive: 4, ..tables.clone() },
            Tables { factor_quantum: -1.0, ..tables.clone() },
            Tables { factor_quantum: f64::NAN, ..tables },
        ] {
            assert_eq!(LandmarkMetric::of(broken), None);
        }
    }
}
