//! The inner loop in the widest vector instructions of the machine.
//!
//! Rows are padded with zeros to a multiple of [`LANES`] numbers. Distances that users see are computed again in double
//! precision.

use pulp::{Arch, NullaryFnOnce};

/// Independent sums for one row; its length is a multiple of this. One row after the other is read from memory more than twice
/// as fast as four at once.
const LANES: usize = 16;

/// Padded length of a row of `dim` numbers.
pub(crate) fn padded(dim: usize) -> usize {
    dim.max(1).next_multiple_of(LANES)
}

/// Sums of Huber's losses of the differences between `query` and each of `rows`, all of length `query.len()`: a difference `d`
/// counts `d²` up to its limit `l`, and beyond it `l (2d - l)`. Squared distances if the limits are infinite.
pub(crate) fn losses_into(query: &[f32], limits: &[f32], rows: &[f32], out: &mut [f32]) {
    Arch::new().dispatch(Losses { query, limits, rows, out });
}

struct Losses<'a> {
    query: &'a [f32],
    limits: &'a [f32],
    rows: &'a [f32],
    out: &'a mut [f32],
}

impl NullaryFnOnce for Losses<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [query, limits] = [self.query, self.limits].map(|row| row.as_chunks::<LANES>().0);
        for (row, out) in self.rows.chunks_exact(self.query.len()).zip(self.out) {
            let mut sums = [0.0; LANES];
            for ((x, y), limits) in query.iter().zip(row.as_chunks::<LANES>().0).zip(limits) {
                for i in 0..LANES {
                    let gap = (x[i] - y[i]).abs();
                    // Not `f32::min`, which takes longer, as it has to leave out what is not a number.
                    let inside = if gap < limits[i] { gap } else { limits[i] };
                    sums[i] += inside * (2.0 * gap - inside);
                }
            }
            *out = sums.iter().sum();
        }
    }
}

/// What the loss that is `sum` by [`losses_into`], in rows of `n` numbers, is at least, also if the limits are rounded to
/// 32 bits, and also by its sum in double precision.
///
/// With `u = 2⁻²⁴`, a rounding makes a number larger by at most the factor `1 + u`. A difference is rounded; its loss grows at
/// most like its square. A limit is rounded; the loss is concave in the limit and zero at zero, so it grows at most like the
/// limit. `2d - l` is rounded, and so is its product, and so is each of at most `n` additions. That is `(1 + u)^(n + 5)`;
/// roundings to 53 bits, also of what is computed here, are less than one more factor. Roundings below the normal numbers are
/// smaller than `2⁻¹⁴⁹` each. A sum that is not finite says nothing.
pub(crate) fn least_loss(sum: f32, n: usize) -> f64 {
    const U: f64 = f32::EPSILON as f64 / 2.0;
    let least = f64::from(sum) * (1.0 - (n + 6) as f64 * U) - f64::from(f32::MIN_POSITIVE);
    if sum.is_finite() { least.max(0.0) } else { 0.0 }
}
