//! Classification by the nearest training shape, over random splits.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};

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

/// Accuracy of the nearest training shape over random splits.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct SplitAccuracy {
    /// Training shapes of each class.
    pub n_train: usize,
    /// Number of random splits.
    pub runs: usize,
    /// Classes that take part: those of more shapes than `n_train`.
    pub n_classes: usize,
    /// Shapes that are classified in each split.
    pub n_test: usize,
    /// Mean share of the test shapes that get their class.
    pub mean: f64,
    /// Standard deviation over the splits; 0 if there is one.
    pub deviation: f64,
}

/// Classifies shapes by the class of the first training shape in their ranking, over random splits.
///
/// Each split draws `n_train` training shapes of every class that has more; the others of these classes are test shapes.
/// Smaller classes take no part. A ranking on a neighbor graph has seen the test shapes, without their classes.
///
/// Returns `None` if fewer than two classes are large enough.
///
/// # Errors
/// [`RetrievalError::LabelCount`].
pub fn split_accuracy(
    rankings: &impl Rankings,
    labels: &Labels,
    options: &SplitOptions,
) -> Result<Option<SplitAccuracy>, RetrievalError> {
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
    let SplitOptions { n_train, runs, .. } = *options;
    Ok(Some(SplitAccuracy { n_train, runs, n_classes: members.len(), n_test, mean, deviation }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ranking::line;

    const ONCE: SplitOptions = SplitOptions { n_train: 2, runs: 50, seed: 7 };

    #[test]
    fn separate_classes_are_classified_without_error() {
        let positions: Vec<f64> = (0..12).map(|i| f64::from(i / 4 * 100 + i)).collect();
        let names: Vec<String> = (0..12).map(|i| (i / 4).to_string()).collect();
        let found = split_accuracy(&line(&positions), &Labels::new(&names), &ONCE).unwrap().unwrap();
        assert_eq!((found.mean, found.deviation, found.n_classes, found.n_test), (1.0, 0.0, 3, 6));
    }

    #[test]
    fn a_shape_far_from_its_class_is_wrong_whenever_it_is_tested() {
        // One of the four of `b` is at 10, nearer to `a` than to the others of `b`, but nearest to nothing.
        let positions = [0.0, 1.0, 2.0, 3.0, 10.0, 100.0, 101.0, 102.0];
        let labels = Labels::new(&["a", "a", "a", "a", "b", "b", "b", "b"]);
        let options = SplitOptions { n_train: 3, runs: 4000, seed: 1 };
        let found = split_accuracy(&line(&positions), &labels, &options).unwrap().unwrap();
        // It is one of the two test shapes in a quarter of the splits: a Bernoulli variable of mean 1/4, halved.
        let (mean, deviation) = (1.0 - 0.25 / 2.0, (0.25f64 * 0.75).sqrt() / 2.0);
        assert!((found.mean - mean).abs() < 4.0 * deviation / 4000f64.sqrt(), "{found:?}");
        assert!((found.deviation - deviation).abs() < 0.01, "{found:?}");
        assert_eq!(split_accuracy(&line(&positions), &labels, &options).unwrap(), Some(found));
    }

    #[test]
    fn classes_that_are_too_small_take_no_part() {
        let labels = Labels::new(&["a", "a", "a", "b", "b", "c", "c", "c"]);
        let positions = [0.0, 1.0, 2.0, 0.5, 1.5, 50.0, 51.0, 52.0];
        let found = split_accuracy(&line(&positions), &labels, &ONCE).unwrap().unwrap();
        assert_eq!((found.n_classes, found.n_test, found.mean), (2, 2, 1.0));
        let one = Labels::new(&["a", "a", "a", "b", "b", "b", "c", "c"]);
        let none = SplitOptions { n_train: 3, ..ONCE };
        assert_eq!(split_accuracy(&line(&positions), &one, &none), Ok(None));
        let short = Labels::new(&["a"]);
        assert!(matches!(
            split_accuracy(&line(&positions), &short, &ONCE),
            Err(RetrievalError::LabelCount { .. })
        ));
    }
}
