//! Confidence intervals of mean scores.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};
use serde::{Deserialize, Serialize};

use crate::{Labels, QueryScores, RetrievalError, Scores};

/// How a confidence interval is found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BootstrapOptions {
    /// Number of resamples. Default: 1000.
    pub resamples: usize,
    /// Probability that the interval covers. Default: 0.95.
    pub level: f64,
    /// Seed of the random numbers. Default: 0.
    pub seed: u64,
}

impl Default for BootstrapOptions {
    fn default() -> Self {
        Self { resamples: 1000, level: 0.95, seed: 0 }
    }
}

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
///
/// # Errors
/// [`RetrievalError::NothingToScore`].
pub fn bootstrap(
    scores: &QueryScores,
    labels: &Labels,
    options: &BootstrapOptions,
) -> Result<ScoreIntervals, RetrievalError> {
    let mut classes: Vec<Vec<[f64; Scores::N]>> = vec![Vec::new(); labels.classes().len()];
    for (query, scores) in &scores.of {
        classes[labels.class(*query)].push(scores.to_array());
    }
    classes.retain(|queries| !queries.is_empty());
    let n_queries: usize = classes.iter().map(Vec::len).sum();
    if n_queries == 0 {
        let (n_points, n_classes) = (labels.n_points(), labels.classes().len());
        return Err(RetrievalError::NothingToScore { n_points, n_classes });
    }
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let mut means: [Vec<f64>; Scores::N] = std::array::from_fn(|_| Vec::with_capacity(options.resamples));
    let weight = 1.0 / n_queries as f64;
    for _ in 0..options.resamples {
        let mut total = [0.0; Scores::N];
        for queries in &classes {
            for _ in 0..queries.len() {
                let drawn = &queries[below(&mut random, queries.len())];
                total.iter_mut().zip(drawn).for_each(|(total, score)| *total += weight * score);
            }
        }
        means.iter_mut().zip(total).for_each(|(means, mean)| means.push(mean));
    }
    means.iter_mut().for_each(|means| means.sort_by(f64::total_cmp));
    let tail = 0.5 * (1.0 - options.level);
    // Scores are shares; rounded sums may exceed 1.
    let score = |i: usize, share: f64| quantile(&means[i], share).clamp(0.0, 1.0);
    let end = |share: f64| Scores::from_array(std::array::from_fn(|i| score(i, share)));
    let (low, high) = (end(tail), end(1.0 - tail));
    Ok(ScoreIntervals { level: options.level, resamples: options.resamples, seed: options.seed, low, high })
}

/// Uniform in `0..bound`, with a bias of at most `bound / 2^64`.
fn below(random: &mut ChaCha8Rng, bound: usize) -> usize {
    ((u128::from(random.next_u64()) * bound as u128) >> 64) as usize
}

/// The quantile of ascending values, interpolated between its two neighbors; NaN if there are none.
fn quantile(sorted: &[f64], share: f64) -> f64 {
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = share.clamp(0.0, 1.0) * last as f64;
    let (low, high) = (at.floor() as usize, at.ceil() as usize);
    sorted[low] + (at - low as f64) * (sorted[high] - sorted[low])
}
