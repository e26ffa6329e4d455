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
    dim.max(1).next_multiple_of(LANES)
}

/// Sums of Huber's losses of the differences between `query` and each of `rows`, all of length `query.len()`: a difference `d`
/// counts `d²` up to its limit `l`, and beyond it `l (2d - l)`. Squared distances if there are no limits.
pub(crate) fn losses_into(query: &[f32], limits: &[f32], rows: &[f32], out: &mut [f32]) {
    match limits.is_empty() {
        // In the cache, losses take 1.5 times as long as squares.
        true => Arch::new().dispatch(Losses::<false> { query, limits: query, rows, out }),
        false => Arch::new().dispatch(Losses::<true> { query, limits, rows, out }),
    }
}

/// What the loss that is `sum` by [`losses_into`], in rows of `n` numbers, is at least, also if the limits are rounded to
/// 32 bits, and also by its sum in double precision.
///
/// With `u = 2⁻²⁴`, a rounding makes a number larger by at most the factor `1 + u`. A difference is rounded; its loss grows at
/// most like its square. A limit is rounded; the loss is concave in the limit and zero at zero, so it grows at most like the
/// limit. `2d - l` is rounded, and so is each of at most `n` additions, with the product that it adds. That is
/// `(1 + u)^(n + 4)`; roundings to 53 bits, also of what is computed here, are less than one more factor. Roundings below
/// the normal numbers are smaller than `2⁻¹⁴⁹` each. A sum that is not finite says nothing.
pub(crate) fn least_loss(sum: f32, n: usize) -> f64 {
    const U: f64 = f32::EPSILON as f64 / 2.0;
    let least = f64::from(sum) * (1.0 - (n + 5) as f64 * U) - f64::from(f32::MIN_POSITIVE);
    if sum.is_finite() { least.max(0.0) } else { 0.0 }
}

struct Losses<'a, const LIMITED: bool> {
    query: &'a [f32],
    limits: &'a [f32],
    rows: &'a [f32],
    out: &'a mut [f32],
}

impl<const LIMITED: bool> WithSimd for Losses<'_, LIMITED> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let n = self.query.len();
        let [query, limits] = [self.query, self.limits].map(|row| S::as_simd_f32s(row).0);
        let (query, query_rest) = query.as_chunks::<SUMS>();
        let (limits, limits_rest) = limits.as_chunks::<SUMS>();
        for (row, out) in self.rows.chunks_exact(n).zip(self.out) {
            let (row, row_rest) = S::as_simd_f32s(row).0.as_chunks::<SUMS>();
            let mut sums = [simd.splat_f32s(0.0); SUMS];
            for ((x, y), limit) in query.iter().zip(row).zip(limits) {
                for i in 0..SUMS {
                    sums[i] = add::<S, LIMITED>(simd, sums[i], x[i], y[i], limit[i]);
                }
            }
            for (((sum, x), y), limit) in sums.iter_mut().zip(query_rest).zip(row_rest).zip(limits_rest) {
                *sum = add::<S, LIMITED>(simd, *sum, *x, *y, *limit);
            }
            let [a, b, c, d] = sums;
            *out = simd.reduce_sum_f32s(simd.add_f32s(simd.add_f32s(a, b), simd.add_f32s(c, d)));
        }
    }
}

/// Adds the losses of the differences of two vectors.
// Closures, and `abs_f32s`, may not be inlined, and are then compiled without vector instructions.
#[inline(always)]
fn add<S: Simd, const LIMITED: bool>(
    simd: S,
    sum: S::f32s,
    x: S::f32s,
    y: S::f32s,
    limit: S::f32s,
) -> S::f32s {
    let gap = simd.sub_f32s(x, y);
    if !LIMITED {
        return simd.mul_add_f32s(gap, gap, sum);
    }
    let gap = simd.max_f32s(gap, simd.sub_f32s(y, x));
    let inside = simd.min_f32s(gap, limit);
    let slope = simd.sub_f32s(simd.add_f32s(gap, gap), inside);
    simd.mul_add_f32s(inside, slope, sum)
}

#[cfg(test)]
mod tests {
    use super::super::testing::{huber, noise};
    use super::*;

    #[test]
    fn losses_are_hardly_above_their_least_value_and_that_is_below_the_sum_in_double_precision() {
        for (dim, n) in [(16, 1), (32, 7), (160, 13), (128, 64)] {
            for width in [1e-25, 1e-10, 1.0, 1e12] {
                let scaled = |seed, n| noise(n, dim, seed).into_iter().map(|x| x * width).collect::<Vec<_>>();
                let (query, rows) = (scaled(3, 1), scaled(4, n));
                let some: Vec<f32> = scaled(5, 1).iter().map(|x| x.abs()).collect();
                for limits in [some, Vec::new()] {
                    let mut found = vec![0.0; n];
                    losses_into(&query, &limits, &rows, &mut found);
                    for (row, found) in rows.chunks(dim).zip(found) {
                        let (loss, least) = (huber(&query, row, &limits).powi(2), least_loss(found, dim));
                        assert!(least <= loss, "{least} {loss}");
                        assert!(least >= (1.0 - 3e-5) * loss || loss < 1e-32, "{least} {loss}");
                    }
                    let mut own = vec![1.0; n];
                    losses_into(&rows[..dim], &limits, &rows, &mut own);
                    assert_eq!(own[0], 0.0, "the distance of a row from itself is zero");
                }
            }
        }
        assert_eq!([f32::INFINITY, f32::NAN].map(|sum| least_loss(sum, 16)), [0.0; 2]);
    }
}
