//! The inner loops, in the widest vector instructions of the machine.
//!
//! Rows are padded with zeros to a multiple of [`LANES`] numbers. Sums are made in an order that depends
//! on the machine: what is shown to people is measured again in double precision.

use pulp::{Arch, Simd, WithSimd};

/// Rows are as long as a multiple of this.
pub(crate) const LANES: usize = 16;

/// Rows measured at a time, so that one sum need not wait for another.
const ROWS: usize = 4;

/// Bytes of centroids that stay in the nearest cache while many points pass.
const TILE: usize = 16 << 10;

/// Length of a row of `dim` numbers once padded.
pub(crate) fn padded(dim: usize) -> usize {
    dim.next_multiple_of(LANES)
}

/// Squared distances from `query` to every one of `rows`; all are `query.len()` long.
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
        let mut groups = self.rows.chunks_exact(ROWS * n);
        let mut places = self.out.chunks_exact_mut(ROWS);
        for (rows, out) in groups.by_ref().zip(places.by_ref()) {
            let rows: [&[S::f32s]; ROWS] = std::array::from_fn(|r| S::as_simd_f32s(&rows[r * n..][..n]).0);
            let rows = rows.map(|row| &row[..query.len()]);
            let mut sums = [simd.splat_f32s(0.0); ROWS];
            for (i, x) in query.iter().enumerate() {
                for (sum, row) in sums.iter_mut().zip(&rows) {
                    let gap = simd.sub_f32s(*x, row[i]);
                    *sum = simd.mul_add_f32s(gap, gap, *sum);
                }
            }
            for (out, sum) in out.iter_mut().zip(sums) {
                *out = simd.reduce_sum_f32s(sum);
            }
        }
        for (row, out) in groups.remainder().chunks_exact(n).zip(places.into_remainder()) {
            let mut sum = simd.splat_f32s(0.0);
            for (x, y) in query.iter().zip(S::as_simd_f32s(row).0) {
                let gap = simd.sub_f32s(*x, *y);
                sum = simd.mul_add_f32s(gap, gap, sum);
            }
            *out = simd.reduce_sum_f32s(sum);
        }
    }
}

/// For each of `points` the nearest of `centroids`, the first among equally near ones. `half_squares` are
/// half the squared lengths of the centroids; all rows are `n` long.
pub(crate) fn nearest_centroids(
    points: &[f32],
    centroids: &[f32],
    half_squares: &[f32],
    n: usize,
) -> Vec<u32> {
    let mut best = vec![(f32::INFINITY, 0u32); points.len() / n];
    let tile = (TILE / (4 * n)).max(2);
    for (i, part) in centroids.chunks(tile * n).enumerate() {
        let first = i * tile;
        let half_squares = &half_squares[first..][..part.len() / n];
        Arch::new().dispatch(Closest {
            points,
            centroids: part,
            half_squares,
            n,
            first: first as u32,
            best: &mut best,
        });
    }
    best.into_iter().map(|(_, centroid)| centroid).collect()
}

struct Closest<'a> {
    points: &'a [f32],
    centroids: &'a [f32],
    half_squares: &'a [f32],
    n: usize,
    first: u32,
    best: &'a mut [(f32, u32)],
}

impl WithSimd for Closest<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.n;
        let mut groups = self.points.chunks_exact(ROWS * n);
        let mut places = self.best.chunks_exact_mut(ROWS);
        for (points, best) in groups.by_ref().zip(places.by_ref()) {
            let points: [&[S::f32s]; ROWS] =
                std::array::from_fn(|r| S::as_simd_f32s(&points[r * n..][..n]).0);
            let length = points[0].len();
            let points = points.map(|point| &point[..length]);
            for (c, (pair, halves)) in
                self.centroids.chunks(2 * n).zip(self.half_squares.chunks(2)).enumerate()
            {
                // The last one alone is paired with itself.
                let centroids =
                    [&pair[..n], &pair[pair.len() - n..]].map(|c| &S::as_simd_f32s(c).0[..length]);
                let mut sums = [[simd.splat_f32s(0.0); ROWS]; 2];
                for i in 0..length {
                    for (sums, centroid) in sums.iter_mut().zip(&centroids) {
                        for (sum, point) in sums.iter_mut().zip(&points) {
                            *sum = simd.mul_add_f32s(point[i], centroid[i], *sum);
                        }
                    }
                }
                for (j, (sums, half)) in sums.iter().zip(halves).enumerate() {
                    for (best, sum) in best.iter_mut().zip(sums) {
                        let score = half - simd.reduce_sum_f32s(*sum);
                        if score < best.0 {
                            *best = (score, self.first + (2 * c + j) as u32);
                        }
                    }
                }
            }
        }
        for (point, best) in groups.remainder().chunks_exact(n).zip(places.into_remainder()) {
            let point = S::as_simd_f32s(point).0;
            for (c, (centroid, half)) in self.centroids.chunks_exact(n).zip(self.half_squares).enumerate() {
                let mut sum = simd.splat_f32s(0.0);
                for (x, y) in point.iter().zip(S::as_simd_f32s(centroid).0) {
                    sum = simd.mul_add_f32s(*x, *y, sum);
                }
                let score = half - simd.reduce_sum_f32s(sum);
                if score < best.0 {
                    *best = (score, self.first + c as u32);
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
    fn distances_are_those_of_the_plain_sum() {
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
            assert_eq!(own[0], 0.0, "a row is at no distance from itself");
        }
    }

    #[test]
    fn the_nearest_centroid_is_the_nearest_and_the_first_of_equals() {
        let dim = 32;
        for (n, k) in [(1, 1), (5, 3), (103, 70), (64, 301)] {
            let (points, mut centroids) = (noise(n, dim, 5), noise(k, dim, 6));
            if k > 3 {
                centroids.copy_within(0..dim, 2 * dim);
            }
            let halves: Vec<f32> =
                centroids.chunks(dim).map(|c| 0.5 * c.iter().map(|x| x * x).sum::<f32>()).collect();
            let found = nearest_centroids(&points, &centroids, &halves, dim);
            for (point, found) in points.chunks(dim).zip(found) {
                let mut gaps = vec![0.0; k];
                sq_distances_into(point, &centroids, &mut gaps);
                let least = gaps.iter().copied().fold(f32::INFINITY, f32::min);
                assert!(gaps[found as usize] <= least * (1.0 + 1e-4));
                assert_ne!(found, if k > 3 { 2 } else { u32::MAX }, "its twin comes first");
            }
        }
    }
}
