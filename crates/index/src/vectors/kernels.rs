//! Inner loops in the widest vector instructions of the machine.
//!
//! Rows are padded with zeros to a multiple of [`LANES`] numbers. The order of summation depends on the machine, so
//! distances that users see are computed again in double precision.

use pulp::{Arch, Simd, WithSimd};

/// The length of a row is a multiple of this.
pub(crate) const LANES: usize = 16;

/// Independent chains of additions for one row. One row after the other is read from memory more than twice as fast as
/// four at once.
const SUMS: usize = 4;

/// Points compared with a group of centres together.
const POINTS: usize = 8;

/// Padded length of a row of `dim` numbers.
pub(crate) fn padded(dim: usize) -> usize {
    dim.next_multiple_of(LANES)
}

/// Squared distances from `query` to each of `rows`, all of length `query.len()`.
pub(crate) fn sq_distances_into(query: &[f32], rows: &[f32], out: &mut [f32]) {
    Arch::new().dispatch(SqDistances { query, rows, out });
}

struct SqDistances<'a> {
    query: &'a [f32],
    rows: &'a [f32],
    out: &'a mut [f32],
}

impl WithSimd for SqDistances<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.query.len();
        let query = S::as_simd_f32s(self.query).0;
        let (query, query_rest) = query.as_chunks::<SUMS>();
        let add = |sum: &mut S::f32s, x: S::f32s, y: S::f32s| {
            let gap = simd.sub_f32s(x, y);
            *sum = simd.mul_add_f32s(gap, gap, *sum);
        };
        for (row, out) in self.rows.chunks_exact(n).zip(self.out) {
            let (row, row_rest) = S::as_simd_f32s(row).0.as_chunks::<SUMS>();
            let mut sums = [simd.splat_f32s(0.0); SUMS];
            for (x, y) in query.iter().zip(row) {
                (0..SUMS).for_each(|i| add(&mut sums[i], x[i], y[i]));
            }
            for ((sum, x), y) in sums.iter_mut().zip(query_rest).zip(row_rest) {
                add(sum, *x, *y);
            }
            let [a, b, c, d] = sums;
            *out = simd.reduce_sum_f32s(simd.add_f32s(simd.add_f32s(a, b), simd.add_f32s(c, d)));
        }
    }
}

/// Centres interleaved so that a vector register holds the same coordinate of several centres, which avoids sums
/// across a register.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Interleaved {
    /// Groups of [`LANES`] centres: the first coordinate of each, then the second of each, ...
    numbers: Vec<f32>,
    /// Half the squared norm of each centre; infinite for unused places of the last group.
    half_squares: Vec<f32>,
    /// Length of a centre.
    n: usize,
}

impl Interleaved {
    /// Takes centres of length `n`, one after the other.
    pub(crate) fn new(centroids: &[f32], n: usize) -> Self {
        let n_groups = (centroids.len() / n).div_ceil(LANES);
        let mut numbers = vec![0.0; n_groups * LANES * n];
        let mut half_squares = vec![f32::INFINITY; n_groups * LANES];
        for (c, centroid) in centroids.chunks_exact(n).enumerate() {
            let group = &mut numbers[c / LANES * LANES * n..][..LANES * n];
            centroid.iter().enumerate().for_each(|(i, x)| group[i * LANES + c % LANES] = *x);
            half_squares[c] = 0.5 * centroid.iter().map(|x| x * x).sum::<f32>();
        }
        Self { numbers, half_squares, n }
    }

    /// The nearest centre of each of `points`; ties go to the first.
    pub(crate) fn nearest(&self, points: &[f32]) -> Vec<u32> {
        let mut best = vec![(f32::INFINITY, 0); points.len() / self.n];
        Arch::new().dispatch(Closest { centres: self, points, best: &mut best });
        best.into_iter().map(|(_, centre)| centre).collect()
    }
}

struct Closest<'a> {
    centres: &'a Interleaved,
    points: &'a [f32],
    best: &'a mut [(f32, u32)],
}

impl WithSimd for Closest<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { centres, points, best } = self;
        let n = centres.n;
        let mut scores = [0.0; LANES];
        let groups = centres.numbers.chunks_exact(LANES * n).zip(centres.half_squares.chunks_exact(LANES));
        // A group of centres stays in the first-level cache while all points pass.
        for (first, (numbers, halves)) in (0u32..).step_by(LANES).zip(groups) {
            for (points, best) in points.chunks(POINTS * n).zip(best.chunks_mut(POINTS)) {
                // Pads the last block with copies of the last point.
                let rows: [&[f32]; POINTS] =
                    std::array::from_fn(|r| &points[r.min(best.len() - 1) * n..][..n]);
                for part in 0..LANES / S::F32_LANES {
                    let mut sums = [simd.splat_f32s(0.0); POINTS];
                    for (i, numbers) in numbers.chunks_exact(LANES).enumerate() {
                        let numbers = S::as_simd_f32s(numbers).0[part];
                        for (sum, row) in sums.iter_mut().zip(&rows) {
                            *sum = simd.mul_add_f32s(simd.splat_f32s(row[i]), numbers, *sum);
                        }
                    }
                    let halves = S::as_simd_f32s(halves).0[part];
                    let first = first + (part * S::F32_LANES) as u32;
                    for (best, sum) in best.iter_mut().zip(sums) {
                        S::as_mut_simd_f32s(&mut scores).0[0] = simd.sub_f32s(halves, sum);
                        for (lane, score) in (0..).zip(&scores[..S::F32_LANES]) {
                            if *score < best.0 {
                                *best = (*score, first + lane);
                            }
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::noise;
    use super::*;

    #[test]
    fn distances_equal_the_plain_sum() {
        for (dim, n) in [(16, 1), (32, 7), (160, 13), (128, 64)] {
            let (query, rows) = (noise(1, dim, 3), noise(n, dim, 4));
            let mut found = vec![0.0; n];
            sq_distances_into(&query, &rows, &mut found);
            for (row, found) in rows.chunks(dim).zip(found) {
                let plain: f64 = row.iter().zip(&query).map(|(x, y)| f64::from(x - y).powi(2)).sum();
                assert!((plain - f64::from(found)).abs() < 1e-5 * plain);
            }
            let mut own = vec![1.0; n];
            sq_distances_into(&rows[..dim], &rows, &mut own);
            assert_eq!(own[0], 0.0, "the distance of a row from itself is zero");
        }
    }

    #[test]
    fn the_nearest_centroid_is_found_and_ties_go_to_the_first() {
        let dim = 32;
        for (n, k) in [(1, 1), (5, 3), (103, 70), (64, 301)] {
            let (points, mut centroids) = (noise(n, dim, 5), noise(k, dim, 6));
            if k > 3 {
                centroids.copy_within(0..dim, 2 * dim);
            }
            let found = Interleaved::new(&centroids, dim).nearest(&points);
            for (point, found) in points.chunks(dim).zip(found) {
                let mut gaps = vec![0.0; k];
                sq_distances_into(point, &centroids, &mut gaps);
                let least = gaps.iter().copied().fold(f32::INFINITY, f32::min);
                assert!(gaps[found as usize] <= least * (1.0 + 1e-4));
                assert_ne!(found, if k > 3 { 2 } else { u32::MAX }, "an equal centroid comes first");
            }
        }
    }
}
