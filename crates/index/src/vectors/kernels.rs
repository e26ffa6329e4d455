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
}
