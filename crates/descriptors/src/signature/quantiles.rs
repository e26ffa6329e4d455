//! Distributions as vectors.

/// The quantiles of weighted samples at the shares `(i + 1/2) / n` of the mass, ascending; zeros without mass.
///
/// These are the centers of a histogram whose `n` bins hold the same mass. The Euclidean distance of two such vectors
/// is `√n` times the 2-Wasserstein distance of the distributions, at the resolution of `n` bins, so that small shifts
/// make small changes; with fixed bins they would not. The distribution is linear between samples.
///
/// Cost: sorting the samples.
pub(super) fn quantiles(samples: impl Iterator<Item = (f64, f64)>, n: usize) -> Vec<f64> {
    let mut samples: Vec<_> = samples.filter(|(value, mass)| value.is_finite() && *mass > 0.0).collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = samples.iter().map(|(_, mass)| mass).sum();
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return vec![0.0; n];
    };
    let (mut below, mut i) = (0.0, 0);
    // Half of the mass of a sample lies below its value.
    let mut before = (0.0, first.0);
    (0..n)
        .map(|bin| {
            let share = (bin as f64 + 0.5) / n as f64 * total;
            while i < samples.len() && below + 0.5 * samples[i].1 < share {
                before = (below + 0.5 * samples[i].1, samples[i].0);
                below += samples[i].1;
                i += 1;
            }
            match samples.get(i) {
                Some((value, mass)) if below > 0.0 => {
                    let at = below + 0.5 * mass;
                    before.1 + (value - before.1) * (share - before.0) / (at - before.0)
                }
                Some((value, _)) => *value,
                None => last.0,
            }
        })
        .collect()
}
