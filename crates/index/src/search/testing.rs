//! Numbers that look random and are always the same.

/// SplitMix64.
struct Stream(u64);

impl Stream {
    /// Uniform in -1..1.
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }
}

/// `n` rows of `dim` numbers.
pub(crate) fn noise(n: usize, dim: usize, seed: u64) -> Vec<f32> {
    let mut stream = Stream(seed);
    (0..n * dim).map(|_| stream.next()).collect()
}

/// `n` rows of `dim` numbers in turn around `k` centres, and the centre of each.
pub(crate) fn clustered(n: usize, k: usize, dim: usize, width: f32) -> (Vec<f32>, Vec<usize>) {
    let (centres, gaps) = (noise(k, dim, 11), noise(n, dim, 12));
    let rows = gaps.iter().enumerate();
    let rows = rows.map(|(i, gap)| centres[i / dim % k * dim + i % dim] + width * gap).collect();
    (rows, (0..n).map(|i| i % k).collect())
}
