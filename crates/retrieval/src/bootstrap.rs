//! Confidence intervals of mean scores.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

use crate::{Labels, QueryScores, Scores};

/// Number of resamples.
const RESAMPLES: usize = 1000;

/// Probability that an interval covers.
const LEVEL: f64 = 0.95;

/// Seed of the random numbers.
const SEED: u64 = 0;

/// A confidence interval of every mean score.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ScoreIntervals {
    /// Probability that each interval covers.
    pub level: f64,
    /// Number of resamples.
    pub resamples: usize,
    /// Seed of the random numbers.
    pub seed: u64,
    /// Lower ends.
    pub low: Scores,
    /// Upper ends.
    pub high: Scores,
}

/// Percentile intervals of the mean scores by a stratified bootstrap (Efron and Tibshirani 1993, `efron1993` in
/// `REFERENCES.bib`): every resample draws as many queries of each class as the class has, with replacement.
///
/// The intervals tell how far the means depend on which shapes of these classes are queries. The gallery stays the same,
/// so they do not tell what other classes would score.
pub fn bootstrap(scores: &QueryScores, labels: &Labels) -> ScoreIntervals {
    let mut classes: Vec<Vec<[f64; Scores::N]>> = vec![Vec::new(); labels.classes().len()];
    for (query, scores) in &scores.of {
        classes[labels.class(*query)].push(scores.to_array());
    }
    classes.retain(|queries| !queries.is_empty());
    let mut random = ChaCha8Rng::seed_from_u64(SEED);
    let mut means: [Vec<f64>; Scores::N] = std::array::from_fn(|_| Vec::with_capacity(RESAMPLES));
    for _ in 0..RESAMPLES {
        let mut total = [0.0; Scores::N];
        for queries in &classes {
            for _ in 0..queries.len() {
                let drawn = &queries[below(&mut random, queries.len())];
                total.iter_mut().zip(drawn).for_each(|(total, score)| *total += score);
            }
        }
        means.iter_mut().zip(total).for_each(|(means, total)| means.push(total / scores.of.len() as f64));
    }
    means.iter_mut().for_each(|means| means.sort_by(f64::total_cmp));
    let tail = 0.5 * (1.0 - LEVEL);
    // Scores are shares; rounded sums may exceed 1.
    let score = |i: usize, share: f64| quantile(&means[i], share).clamp(0.0, 1.0);
    let end = |share: f64| Scores::from_array(std::array::from_fn(|i| score(i, share)));
    let (low, high) = (end(tail), end(1.0 - tail));
    ScoreIntervals { level: LEVEL, resamples: RESAMPLES, seed: SEED, low, high }
}

/// Uniform in `0..bound`, with a bias of at most `bound / 2^64`.
fn below(random: &mut ChaCha8Rng, bound: usize) -> usize {
    ((u128::from(random.next_u64()) * bound as u128) >> 64) as usize
}

/// The quantile of ascending values, interpolated between its two neighbors.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let at = share * (sorted.len() - 1) as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    sorted[low] + (at - low as f64) * (sorted[high] - sorted[low])
}
