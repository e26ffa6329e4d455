//! The stress of an embedding, estimated from a few rows of distances.

use std::ops::{Add, Range};

use linalg::{LandmarkDistances, LinalgError, Matrix};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use rayon::prelude::*;

use crate::DistanceRows;
use crate::stress::{Kruskal, residuals};

/// An estimate of [`stress`](crate::stress()) from some of the rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StressEstimate {
    /// The estimate of [`paper_stress`](crate::paper_stress), in the unit of a squared distance.
    pub value: f64,
    /// The estimate of [`normalized_stress`](crate::normalized_stress), without a unit.
    pub normalized: f64,
    /// 95 % confidence interval of `value`.
    pub interval: [f64; 2],
    /// 95 % confidence interval of `normalized`.
    pub normalized_interval: [f64; 2],
    /// Number of different rows used.
    pub n_rows: usize,
}

/// Rows of a p x p matrix of distances that an estimate is made from.
#[derive(Debug, Clone, PartialEq)]
pub struct RowSample {
    /// The rows; one that is drawn twice counts twice.
    rows: Vec<usize>,
    /// For each, the mean probability of a row over its own.
    weights: Vec<f64>,
    /// Per row of the matrix, what is subtracted from the residuals of that row and column; empty for zeros.
    offsets: Vec<f64>,
    /// Share of the variance that is left because rows are drawn without replacement; 1 if they are not.
    correction: f64,
}

/// The share of the mean that is added to what is expected of every row: a safety limit, so that none is nearly
/// impossible. The estimate is unbiased for any share.
const LEVEL: f64 = 0.5;

impl RowSample {
    /// Takes these rows, which should be different and a random choice from all `n_points` rows.
    #[must_use]
    pub fn of_rows(rows: Vec<usize>, n_points: usize) -> Self {
        let (m, correction) = (rows.len(), 1.0 - rows.len() as f64 / n_points.max(1) as f64);
        Self { rows, weights: vec![1.0; m], offsets: Vec::new(), correction }
    }

    /// Draws `m` different rows (at most `n_points`) with `seed`, all equally likely; see [`sample_rows`].
    #[must_use]
    pub fn uniform(n_points: usize, m: usize, seed: u64) -> Self {
        Self::of_rows(sample_rows(n_points, m, seed), n_points)
    }

    /// Draws `m` rows with `seed` so that few of them give a narrow interval, by what the distances from landmarks tell of
    /// every row. The estimate is as unbiased as from [`uniform`](Self::uniform) rows, and so is its variance: the
    /// landmarks decide which rows are drawn, but their residuals, which are smaller than others, do not enter.
    ///
    /// With `r_ij` the residual of point i and landmark j, and `w_j` the share of points nearest to landmark j:
    ///
    /// * The residuals are centred by `u_i = sum_j w_j r_ij` minus half the mean of `u`: the stress is the norm of
    ///   `1/2 J D J`, which does not change if `u_i + u_k` is subtracted from every `D_ik`. The means of rows, which vary
    ///   most, are then nearly zero.
    /// * Row i is drawn with a probability proportional to the estimate `sum_j w_j (r_ij - u_i - u_j)^2` of what it
    ///   contributes, plus half the mean, with replacement (Hansen and Hurwitz 1943, `hansen1943` in `REFERENCES.bib`): one row
    ///   from each of `m` strata along the first coordinate. Intervals are those of rows without strata, and rather wide.
    ///
    /// On canonical forms of animals and humans, 4 rows then give an interval of +-30 % and 20 rows one of +-8 %, four times
    /// as narrow as with equally likely rows.
    ///
    /// `coords` are in units of `unit`, which is in the unit of the distances. Cost: `O(p n k)` time, three passes over the
    /// distances.
    ///
    /// # Errors
    /// [`LinalgError::File`].
    pub fn by_landmarks(
        coords: &Matrix,
        distances: &LandmarkDistances,
        unit: f64,
        m: usize,
        seed: u64,
    ) -> Result<Self, LinalgError> {
        let landmarks = distances.landmarks();
        let blocks = distances.blocks();
        let shares = shares(distances)?;
        // Residuals of all points of a block and all landmarks.
        let of_block = |rows: Range<usize>| {
            let mut block = distances.rows(rows.clone())?;
            for (mut column, &landmark) in block.column_iter_mut().zip(landmarks) {
                let column = column.as_mut_slice();
                column.iter_mut().for_each(|d| *d = (*d / unit).powi(2));
                for z in coords.column_iter() {
                    let at = z[landmark];
                    let points = &z.as_slice()[rows.clone()];
                    column.iter_mut().zip(points).for_each(|(r, x)| *r -= (x - at) * (x - at));
                }
            }
            Ok::<_, LinalgError>(block)
        };
        let flat = |parts: Vec<Vec<f64>>| parts.into_iter().flatten().collect::<Vec<f64>>();
        let means = |rows: Range<usize>| {
            let mut means = vec![0.0; rows.len()];
            for (column, share) in of_block(rows)?.column_iter().zip(&shares) {
                means.iter_mut().zip(column.as_slice()).for_each(|(mean, r)| *mean += share * r);
            }
            Ok(means)
        };
        let means = blocks.clone().into_par_iter().map(means).collect::<Result<Vec<_>, LinalgError>>()?;
        let mut offsets = flat(means);
        let half = 0.5 * landmarks.iter().zip(&shares).map(|(&j, share)| share * offsets[j]).sum::<f64>();
        offsets.iter_mut().for_each(|offset| *offset -= half);
        let expected = |rows: Range<usize>| {
            let mut expected = vec![0.0; rows.len()];
            for ((column, share), &j) in of_block(rows.clone())?.column_iter().zip(&shares).zip(landmarks) {
                let residuals = column.as_slice().iter().zip(&offsets[rows.clone()]);
                for (sum, (r, own)) in expected.iter_mut().zip(residuals) {
                    *sum += share * (r - own - offsets[j]).powi(2);
                }
            }
            Ok(expected)
        };
        let expected = blocks.into_par_iter().map(expected).collect::<Result<Vec<_>, LinalgError>>()?;
        let mut expected = flat(expected);
        let p = expected.len().max(1) as f64;
        let mean = expected.iter().sum::<f64>() / p;
        expected.iter_mut().for_each(|x| *x = if mean > 0.0 { *x / mean + LEVEL } else { 1.0 });
        let total: f64 = expected.iter().sum();
        let mut order: Vec<usize> = (0..expected.len()).collect();
        if let Some(along) = coords.column_iter().next() {
            order.sort_by(|i, j| along[*i].total_cmp(&along[*j]));
        }
        let rows = drawn(&expected, &order, m, seed);
        let weights = rows.iter().map(|&i| total / (p * expected[i])).collect();
        Ok(Self { rows, weights, offsets, correction: 1.0 })
    }

    /// The rows that are needed, in ascending order without repetitions.
    #[must_use]
    pub fn rows(&self) -> Vec<usize> {
        let mut rows = self.rows.clone();
        rows.sort_unstable();
        rows.dedup();
        rows
    }
}

/// `m` distinct numbers below `p` (at most `p`), ascending, drawn with `seed` by Floyd's algorithm.
#[must_use]
pub fn sample_rows(p: usize, m: usize, seed: u64) -> Vec<usize> {
    let m = m.min(p);
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut chosen = std::collections::BTreeSet::new();
    for limit in p - m..p {
        let pick = (rng.next_u64() % (limit as u64 + 1)) as usize;
        if !chosen.insert(pick) {
            chosen.insert(limit);
        }
    }
    chosen.into_iter().collect()
}

/// The share of points that are nearest to each landmark, the first in case of a tie.
fn shares(distances: &LandmarkDistances) -> Result<Vec<f64>, LinalgError> {
    let n = distances.n_landmarks();
    let nearest = |rows: Range<usize>| {
        let (mut nearest, mut least) = (vec![0; rows.len()], vec![f64::INFINITY; rows.len()]);
        for (j, column) in distances.rows(rows)?.column_iter().enumerate() {
            for ((d, nearest), least) in column.as_slice().iter().zip(&mut nearest).zip(&mut least) {
                (*nearest, *least) = if d < least { (j, *d) } else { (*nearest, *least) };
            }
        }
        let mut counts = vec![0usize; n];
        nearest.into_iter().for_each(|j: usize| counts[j] += 1);
        Ok(counts)
    };
    let counts = distances.blocks().into_par_iter().map(nearest).collect::<Result<Vec<_>, LinalgError>>()?;
    let total = |j: usize| counts.iter().map(|block: &Vec<usize>| block[j]).sum::<usize>() as f64;
    Ok((0..n).map(|j| total(j) / distances.n_points().max(1) as f64).collect())
}

/// `m` numbers, drawn with probabilities proportional to `sizes`: one from each of `m` strata of equal size, which follow one
/// another in `order`.
fn drawn(sizes: &[f64], order: &[usize], m: usize, seed: u64) -> Vec<usize> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut uniform = || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
    let stratum = sizes.iter().sum::<f64>() / m as f64;
    let mut marks = (0..m).map(|k| (k as f64 + uniform()) * stratum).peekable();
    let (mut rows, mut sum) = (Vec::with_capacity(m), 0.0);
    for &i in order {
        sum += sizes[i];
        while marks.next_if(|mark| *mark < sum).is_some() {
            rows.push(i);
        }
    }
    // Rounding of the sum.
    rows.extend(marks.filter_map(|_| order.last()));
    rows
}

/// Residuals of a row that are held at once.
const PART: usize = 1 << 13;

/// Quantiles of Student's t distribution at 0.99, for 1, 2, ... degrees of freedom.
const T_99: [f64; 30] = [
    31.821, 6.965, 4.541, 3.747, 3.365, 3.143, 2.998, 2.896, 2.821, 2.764, 2.7181, 2.681, 2.650, 2.624,
    2.602, 2.583, 2.567, 2.552, 2.539, 2.528, 2.518, 2.508, 2.500, 2.492, 2.485, 2.479, 2.473, 2.467, 2.462,
    2.457,
];

/// The quantile at 0.99 with this many degrees of freedom, at most 0.3 % too large.
fn t_99(freedom: usize) -> f64 {
    match freedom {
        ..=30 => T_99[freedom.saturating_sub(1)],
        // Cornish and Fisher's expansion.
        _ => 2.3264 + 3.73 / freedom as f64 + 5.7 / (freedom * freedom) as f64,
    }
}

/// Estimates [`stress`](crate::stress()) from a sample of rows.
///
/// The squared stress is `(A - B - V) / 4`, where `A` is the mean over rows of their mean square residual, `B` the mean
/// of the squares of their mean residuals, and `V` the variance of these means. (Rows and columns have the same sums
/// because `E` is symmetric.) Each is a mean over rows, and a weighted mean over the sample estimates it without bias.
///
/// The interval follows from the variance of what each row contributes, by Student's t. Residuals have long tails: a few
/// rows, at the tips of limbs, contribute far more than others, and a sample without them has too small a variance. For that
/// reason it uses the 98 % quantile. Over 28 forms of 7 meshes, with 3 to 20 rows by [`RowSample::by_landmarks`], 96 % of
/// the intervals then contain the exact stress; of a single form, 83 % or more do.
///
/// The squared normalised stress is a ratio of two sums over rows; its interval follows from the variance of the residuals of
/// that ratio (Cochran 1977, `cochran1977` in `REFERENCES.bib`).
///
/// Cost: each sampled row once, `O(p k)` time each.
///
/// # Errors
/// Those of the rows.
pub fn estimate_stress(
    coords: &Matrix,
    rows: &dyn DistanceRows,
    sample: &RowSample,
) -> Result<StressEstimate, LinalgError> {
    let p = rows.n_points();
    let n = p as f64;
    let different = sample.rows();
    // For each row, the mean square and the mean of the residuals.
    let solved = different
        .par_iter()
        .map(|&i| {
            let mut distances = vec![0.0; p];
            rows.row_into(i, &mut distances)?;
            let (mut moments, mut kruskal) = ([0.0; 2], Kruskal::default());
            let mut part = vec![0.0; PART.min(p)];
            for (start, distances) in (0..p).step_by(PART).zip(distances.chunks(PART)) {
                let part = &mut part[..distances.len()];
                residuals(coords, distances, i, start, part);
                kruskal = kruskal + Kruskal::of_row(distances, part);
                if let Some(own) = sample.offsets.get(i) {
                    part.iter_mut().zip(&sample.offsets[start..]).for_each(|(r, other)| *r -= own + other);
                }
                moments[0] += part.iter().map(|d| d * d).sum::<f64>() / n;
                moments[1] += part.iter().sum::<f64>() / n;
            }
            Ok((moments, kruskal))
        })
        .collect::<Result<Vec<_>, LinalgError>>()?;
    let m = sample.rows.len();
    let of =
        |row: &usize| different.binary_search(row).unwrap_or_else(|_| unreachable!("row {row} is solved"));
    let weighted = || sample.rows.iter().map(|row| solved[of(row)]).zip(&sample.weights);
    let scaled =
        |(_, k): ([f64; 2], Kruskal), w: f64| Kruskal { residual: w * k.residual, total: w * k.total };
    let sums = weighted().map(|(row, w)| scaled(row, *w)).fold(Kruskal::default(), Add::add);
    let normalized = sums.stress();

    let mean = |of: &dyn Fn([f64; 2], f64) -> f64| {
        weighted().map(|((moments, _), w)| of(moments, *w)).sum::<f64>() / m.max(1) as f64
    };
    let [squares, means_sq, centre] =
        [mean(&|[s, _], w| w * s), mean(&|[_, mean], w| w * mean * mean), mean(&|[_, mean], w| w * mean)];
    let freedom = m.saturating_sub(1).max(1) as f64;
    // The square of a mean is too large by the variance of the mean.
    let excess = mean(&|[_, mean], w| (w * mean - centre).powi(2)) / freedom * sample.correction;
    let quadruple = squares - 2.0 * means_sq + centre * centre - excess;
    let part = |[s, mean]: [f64; 2], w: f64| w * (s - 2.0 * mean * mean + 2.0 * centre * mean);
    let level = mean(&part);
    let variance = mean(&|moments, w| (part(moments, w) - level).powi(2)) / freedom * sample.correction;
    let half = |variance: f64| match m {
        // All rows.
        _ if sample.correction == 0.0 => 0.0,
        0 | 1 => f64::INFINITY,
        _ => t_99(m - 1) * variance.sqrt(),
    };
    let around = |square: f64, half: f64| [square - half, square + half].map(|end| end.max(0.0).sqrt());
    let interval = around(quadruple, half(variance)).map(|end| 0.5 * end);

    // The square of the normalised stress is a ratio of two means, so its variance is that of the residuals of the ratio.
    let ratio = normalized * normalized;
    let residual = |row, w: f64| {
        let Kruskal { residual, total } = scaled(row, w);
        (residual - ratio * total).powi(2)
    };
    let spread = weighted().map(|(row, w)| residual(row, *w)).sum::<f64>() / m.max(1) as f64 / freedom;
    let mean_total = sums.total / m.max(1) as f64;
    let variance = if mean_total > 0.0 { spread * sample.correction / mean_total.powi(2) } else { 0.0 };
    let normalized_interval = around(ratio, half(variance));
    let value = 0.5 * quadruple.max(0.0).sqrt();
    Ok(StressEstimate { value, normalized, interval, normalized_interval, n_rows: different.len() })
}

#[cfg(test)]
mod tests {
    use linalg::DistanceMatrix;

    use super::*;
    use crate::tests::support::Cloud;
    use crate::{classical, stress};

    /// Distances that are not Euclidean, their best embedding in the plane, and the distances from 8 of the points.
    fn bent(p: usize) -> (DistanceMatrix, Matrix, LandmarkDistances) {
        let cloud = Cloud::new(p, 3, 21);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(0.7)).unwrap();
        let coords = classical(&distances, 2, &()).unwrap().coords;
        let landmarks: Vec<usize> = (0..8).map(|j| j * p / 8).collect();
        let columns = Matrix::from_fn(p, 8, |i, j| distances.get(i, landmarks[j]));
        (distances, coords, LandmarkDistances::new(landmarks, columns).unwrap())
    }

    #[test]
    fn estimates_from_all_rows_are_exact() {
        let (distances, coords, landmarks) = bent(300);
        let exact = stress(&coords, &distances).unwrap();
        let all = estimate_stress(&coords, &distances, &RowSample::uniform(300, 1000, 0)).unwrap();
        assert!((all.value / exact.paper - 1.0).abs() < 1e-12 && all.n_rows == 300);
        assert!((all.normalized / exact.normalized - 1.0).abs() < 1e-12);
        assert!(all.interval[1] - all.interval[0] < 1e-9 * exact.paper);
        assert_eq!(all.normalized_interval[0], all.normalized_interval[1]);
        // Offsets change nothing.
        let offsets = RowSample::by_landmarks(&coords, &landmarks, 1.0, 2, 0).unwrap().offsets;
        let centred = RowSample { offsets, ..RowSample::uniform(300, 300, 0) };
        let centred = estimate_stress(&coords, &distances, &centred).unwrap();
        assert!((centred.value / exact.paper - 1.0).abs() < 1e-12);
    }

    #[test]
    fn estimates_are_unbiased_and_intervals_cover_the_exact_stress() {
        let (distances, coords, landmarks) = bent(300);
        let exact = stress(&coords, &distances).unwrap();
        type Draw<'a> = &'a dyn Fn(usize, u64) -> RowSample;
        let uniform: Draw<'_> = &|m, seed| RowSample::uniform(300, m, seed);
        let guided: Draw<'_> = &|m, seed| RowSample::by_landmarks(&coords, &landmarks, 1.0, m, seed).unwrap();
        for (name, draw, m) in [("uniform", uniform, 20), ("guided", guided, 4), ("guided", guided, 20)] {
            let runs = 300;
            let found: Vec<_> =
                (0..runs).map(|seed| estimate_stress(&coords, &distances, &draw(m, seed)).unwrap()).collect();
            let covered = found.iter().filter(|e| (e.interval[0]..=e.interval[1]).contains(&exact.paper));
            let covered = covered.count() as f64 / runs as f64;
            let mean_square = found.iter().map(|e| e.value.powi(2)).sum::<f64>() / runs as f64;
            let width = found.iter().map(|e| e.interval[1] - e.interval[0]).sum::<f64>() / runs as f64;
            println!("{name} {m}: {covered:.3} covered, width {:.3}", width / exact.paper);
            assert!(covered > 0.93, "{name} {m}: {covered}");
            let within = |e: &&StressEstimate| {
                (e.normalized_interval[0]..=e.normalized_interval[1]).contains(&exact.normalized)
            };
            let covered = found.iter().filter(within).count() as f64 / runs as f64;
            println!("{name} {m}: {covered:.3} of the normalised stress covered");
            assert!(covered > 0.93, "{name} {m}, normalised: {covered}");
            assert!((mean_square / exact.paper.powi(2) - 1.0).abs() < 0.05, "{name} {m}");
        }
    }

    #[test]
    fn one_row_has_no_interval() {
        let (distances, coords, landmarks) = bent(50);
        for sample in
            [RowSample::uniform(50, 1, 3), RowSample::by_landmarks(&coords, &landmarks, 1.0, 1, 3).unwrap()]
        {
            let found = estimate_stress(&coords, &distances, &sample).unwrap();
            for interval in [found.interval, found.normalized_interval] {
                assert_eq!(interval, [0.0, f64::INFINITY]);
            }
        }
        let point = DistanceMatrix::from_rows(1, vec![0.0]).unwrap();
        let found = estimate_stress(&Matrix::zeros(1, 2), &point, &RowSample::uniform(1, 4, 0)).unwrap();
        assert_eq!((found.value, found.interval), (0.0, [0.0; 2]));
    }

    #[test]
    fn an_exact_embedding_has_no_stress() {
        let cloud = Cloud::new(60, 2, 4);
        let distances = DistanceMatrix::from_pairs(60, |i, j| cloud.distance(i, j)).unwrap();
        let coords = classical(&distances, 2, &()).unwrap().coords;
        let columns = Matrix::from_fn(60, 5, |i, j| distances.get(i, j));
        let landmarks = LandmarkDistances::new((0..5).collect(), columns).unwrap();
        let sample = RowSample::by_landmarks(&coords, &landmarks, 1.0, 4, 0).unwrap();
        let found = estimate_stress(&coords, &distances, &sample).unwrap();
        assert!(found.value < 1e-6 && found.interval[1] < 1e-6, "{found:?}");
    }

    #[test]
    fn the_number_of_threads_changes_nothing() {
        let (distances, coords, landmarks) = bent(500);
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let sample = RowSample::by_landmarks(&coords, &landmarks, 1.0, 9, 2).unwrap();
                estimate_stress(&coords, &distances, &sample).unwrap()
            })
        };
        assert_eq!(with(1), with(4));
    }

    #[test]
    fn quantiles_decrease_to_that_of_the_normal_distribution() {
        assert!((1..200).all(|f| t_99(f) > t_99(f + 1)));
        assert!((t_99(60) - 2.390).abs() < 0.003 && (t_99(120) - 2.358).abs() < 0.003);
    }
}
