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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_few_samples_leave_out_what_is_no_number_or_has_no_mass() {
        let samples = [(3.0, 1e-3), (1.0, 3e-3), (f64::NAN, 1.0), (7.0, 0.0)];
        let [low, high] = quantiles(samples.into_iter(), 2)[..] else { panic!() };
        assert!(low == 1.0 && high > 1.0 && high <= 3.0);
        assert_eq!(quantiles([(5.0, 2.0)].into_iter(), 3), [5.0; 3]);
        assert_eq!(quantiles(std::iter::empty(), 3), [0.0; 3]);
    }

    #[test]
    fn the_distribution_is_linear_between_the_middles_of_samples() {
        // Half of the mass of each lies below its value: .5 of 7 below 1, 3 below 4, 6 below 9.
        let found = quantiles([(9.0, 2.0), (1.0, 1.0), (4.0, 4.0)].into_iter(), 4);
        let middle = |share: f64| {
            if share < 3.0 {
                1.0 + 3.0 * (share - 0.5) / 2.5
            } else {
                f64::min(4.0 + 5.0 * (share - 3.0) / 3.0, 9.0)
            }
        };
        for (bin, found) in found.into_iter().enumerate() {
            let expected = middle((bin as f64 + 0.5) / 4.0 * 7.0);
            assert!((found - expected).abs() < 1e-12, "{bin}: {found} {expected}");
        }
    }
}
