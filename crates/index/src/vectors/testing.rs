//! Reproducible random vectors for tests.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// `n` vectors of `dim` numbers, uniform in -1..1.
pub(crate) fn noise(n: usize, dim: usize, seed: u64) -> Vec<f32> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..n * dim).map(|_| (rng.next_u64() >> 40) as f32 / (1 << 23) as f32 - 1.0).collect()
}

/// The root of the sum of Huber's losses, in double precision.
pub(crate) fn huber(a: &[f32], b: &[f32], limits: &[f32]) -> f64 {
    let limits = limits.iter().copied().chain(std::iter::repeat(f32::INFINITY));
    let loss = |((x, y), limit): ((&f32, &f32), f32)| {
        let gap = (f64::from(*x) - f64::from(*y)).abs();
        let inside = gap.min(f64::from(limit));
        inside * (2.0 * gap - inside)
    };
    a.iter().zip(b).zip(limits).map(loss).sum::<f64>().sqrt()
}
