//! Classification by the nearest training shape, over random splits.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use crate::bootstrap::below;
use crate::{Labels, Rankings, RetrievalError};

/// How a collection is split.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SplitOptions {
    /// Training shapes of each class.
    pub n_train: usize,
    /// Number of random splits.
    pub runs: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

/// Classifies shapes by the class of the first training shape in their ranking, over random splits.
///
/// Each split draws `n_train` training shapes of every class that has more; the others of these classes are test shapes.
/// Smaller classes take no part. A ranking on a neighbor graph has seen the test shapes, without their classes.
///
/// Returns the mean share of the test shapes that get their class and its standard deviation over the splits, 0 if there is one;
/// `None` if fewer than two classes are large enough.
///
/// # Errors
/// [`RetrievalError::LabelCount`].
pub fn split_accuracy(
    rankings: &impl Rankings,
    labels: &Labels,
    options: &SplitOptions,
) -> Result<Option<[f64; 2]>, RetrievalError> {
    let (n_points, n_labels) = (rankings.n_points(), labels.n_points());
    if n_labels != n_points {
        return Err(RetrievalError::LabelCount { n_labels, n_points });
    }
    let takes_part = |class: usize| labels.size(class) > options.n_train;
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); labels.classes().len()];
    (0..n_points).filter(|i| takes_part(labels.class(*i))).for_each(|i| members[labels.class(i)].push(i));
    members.retain(|members| !members.is_empty());
    if members.len() < 2 || options.n_train == 0 || options.runs == 0 {
        return Ok(None);
    }
    // The nearest first, without shapes that take no part.
    let orders: Vec<Vec<u32>> = (0..n_points)
        .map(|query| match takes_part(labels.class(query)) {
            false => Vec::new(),
            true => {
                let ranking = rankings.ranking(query).into_iter();
                ranking.filter(|n| takes_part(labels.class(n.index))).map(|n| n.index as u32).collect()
            }
        })
        .collect();
    let mut random = ChaCha8Rng::seed_from_u64(options.seed);
    let mut accuracies = Vec::with_capacity(options.runs);
    let n_test = members.iter().map(|members| members.len() - options.n_train).sum::<usize>();
    for _ in 0..options.runs {
        let mut trains = vec![false; n_points];
        for members in &mut members {
            // The first `n_train` of a random order (Fisher and Yates).
            for i in 0..options.n_train {
                let other = i + below(&mut random, members.len() - i);
                members.swap(i, other);
                trains[members[i]] = true;
            }
        }
        let tests = members.iter().flat_map(|members| &members[options.n_train..]);
        let is_right = |query: &&usize| {
            let nearest = orders[**query].iter().find(|i| trains[**i as usize]);
            nearest.is_some_and(|i| labels.class(*i as usize) == labels.class(**query))
        };
        accuracies.push(tests.filter(is_right).count() as f64 / n_test as f64);
    }
    let runs = accuracies.len() as f64;
    let mean = accuracies.iter().sum::<f64>() / runs;
    let squares: f64 = accuracies.iter().map(|accuracy| (accuracy - mean).powi(2)).sum();
    let deviation = if runs > 1.0 { (squares / (runs - 1.0)).sqrt() } else { 0.0 };
    Ok(Some([mean, deviation]))
}
