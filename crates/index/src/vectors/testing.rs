//! Reproducible random vectors for tests.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// `n` vectors of `dim` numbers, uniform in -1..1.
pub(crate) fn noise(n: usize, dim: usize, seed: u64) -> Vec<f32> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    (0..n * dim).map(|_| (rng.next_u64() >> 40) as f32 / (1 << 23) as f32 - 1.0).collect()
}

/// `n` vectors of `dim` numbers around `k` centres in turn, and the number of each one's centre.
pub(crate) fn clustered(n: usize, k: usize, dim: usize, width: f32) -> (Vec<f32>, Vec<usize>) {
    let (centres, offsets) = (noise(k, dim, 11), noise(n, dim, 12));
    let rows = offsets.iter().enumerate();
    let rows = rows.map(|(i, offset)| centres[i / dim % k * dim + i % dim] + width * offset).collect();
    (rows, (0..n).map(|i| i % k).collect())
}
