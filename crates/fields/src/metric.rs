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

    /// The estimate of the distance of two points, in what the landmarks leave open if the columns have no error, and the
    /// interval that holds the distance; in the unit of the distances.
    pub(crate) fn pair(&self, a: usize, b: usize) -> (f64, Interval) {
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
        (distance.max(open.lower).min(open.upper), bounds)
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
    fn product(&self, a: usize, b: usize) -> f64 {
        let Tables { rank, n_positive, ref factor, .. } = self.tables;
        let row = |point: usize| factor[point * rank..][..rank].split_at(n_positive);
        let ((positive_a, negative_a), (positive_b, negative_b)) = (row(a), row(b));
        dot(positive_a, positive_b) - dot(negative_a, negative_b)
    }
}

/// The largest difference and the smallest sum of the entries of two rows.
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
