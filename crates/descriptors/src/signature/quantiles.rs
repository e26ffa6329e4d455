//! Distributions as vectors.

/// The quantiles of weighted samples at the shares `(i + 1/2) / n` of the mass, ascending; zeros without mass.
///
/// These are the centers of a histogram whose `n` bins hold the same mass. The Euclidean distance of two such vectors
/// is `√n` times the 2-Wasserstein distance of the distributions, at the resolution of `n` bins, so that small shifts
/// make small changes; with fixed bins they would not. The distribution is linear between samples.
///
/// Cost: two passes over the samples, and sorting the few of them near the quantiles.
pub(super) fn quantiles(samples: impl Iterator<Item = (f64, f64)> + Clone, n: usize) -> Vec<f64> {
    let samples = samples.filter(|(value, mass)| value.is_finite() && *mass > 0.0);
    let mut samples = condensed(samples, n);
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

/// Bins of samples. A convention of time.
const CELLS: usize = 1024;

/// The samples, with those of each bin that is far from all quantiles replaced by one of their mass.
fn condensed(samples: impl Iterator<Item = (f64, f64)> + Clone, n: usize) -> Vec<(f64, f64)> {
    let [mut low, mut high, mut total, mut count] = [f64::INFINITY, f64::NEG_INFINITY, 0.0, 0.0];
    samples.clone().for_each(|(value, mass)| {
        (low, high) = (low.min(value), high.max(value));
        (total, count) = (total + mass, count + 1.0);
    });
    if count < 4.0 * CELLS as f64 || low == high {
        return samples.collect();
    }
    let scale = CELLS as f64 / (high - low);
    let cell = |value: f64| (((value - low) * scale) as usize).min(CELLS - 1);
    let mut cells = vec![(0.0, 0.0); CELLS];
    samples.clone().for_each(|(value, mass)| {
        let (moment, sum) = &mut cells[cell(value)];
        (*moment, *sum) = (*moment + value * mass, *sum + mass);
    });
    let mut is_kept = [false; CELLS];
    let filled: Vec<usize> = (0..CELLS).filter(|c| cells[*c].1 > 0.0).collect();
    let mut below = 0.0;
    let mut bin = 0;
    for (i, c) in filled.iter().enumerate() {
        below += cells[*c].1;
        while bin < n && (bin as f64 + 0.5) / n as f64 * total <= below {
            // A quantile lies between two samples, which may be in two bins.
            let around = i.saturating_sub(1)..(i + 2).min(filled.len());
            filled[around].iter().for_each(|c| is_kept[*c] = true);
            bin += 1;
        }
    }
    let others = filled.iter().filter(|c| !is_kept[**c]).map(|c| (cells[*c].0 / cells[*c].1, cells[*c].1));
    let mut kept: Vec<(f64, f64)> = others.collect();
    samples.filter(|(value, _)| is_kept[cell(*value)]).for_each(|sample| kept.push(sample));
    kept
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
    fn quantiles_of_many_samples_are_those_of_all_of_them_sorted() {
        // Crowded at one end, with gaps, and in no order.
        let value = |i: u32| {
            let share = f64::from(i.wrapping_mul(2_654_435_761) >> 12) / f64::from(1 << 20);
            share.powi(4) + f64::from(i % 3) * 5.0
        };
        let samples = (0..20_000).map(|i| (value(i), 1.0 + f64::from(i % 7)));
        let mut sorted: Vec<(f64, f64)> = samples.clone().collect();
        sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
        let total: f64 = sorted.iter().map(|(_, mass)| mass).sum();
        let mut middles = Vec::new();
        let mut below = 0.0;
        for (value, mass) in sorted {
            middles.push((below + 0.5 * mass, value));
            below += mass;
        }
        for (bin, found) in quantiles(samples, 40).into_iter().enumerate() {
            let share = (bin as f64 + 0.5) / 40.0 * total;
            let next = middles.partition_point(|(middle, _)| *middle < share);
            let [(m, x), (n, y)] = [middles[next - 1], middles[next]];
            let expected = x + (y - x) * (share - m) / (n - m);
            assert!((found - expected).abs() < 1e-9, "{bin}: {found} {expected}");
        }
    }
}
