//! Scores averaged in two ways, and precision over recall.

use linalg::DistanceMatrix;
use serde::{Deserialize, Serialize};

use crate::{Labels, QueryScores, RetrievalError, rank};

/// What a mean is taken over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Averaging {
    /// Over queries: large classes count more.
    Micro,
    /// Over the means of the classes: all classes count the same.
    Macro,
}

/// Mean retrieval scores.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeanScores {
    /// Nearest neighbour.
    pub nn: f64,
    /// First tier.
    pub ft: f64,
    /// Second tier.
    pub st: f64,
    /// E-measure at rank min(32, n - 1).
    pub e: f64,
    /// Normalised discounted cumulative gain.
    pub dcg: f64,
    /// Mean average precision.
    pub map: f64,
}

/// The scores of a labelled matrix of distances, by the conventions of [`evaluate`](crate::evaluate).
///
/// # Errors
/// [`RetrievalError::LabelCount`], [`RetrievalError::NothingToScore`].
pub fn mean_scores(
    distances: &DistanceMatrix,
    labels: &Labels,
    averaging: Averaging,
) -> Result<MeanScores, RetrievalError> {
    let query = |i: usize| {
        let s = QueryScores::new(&rank(distances, i), i, labels)?;
        let (ft, st) = (s.first_tier, s.second_tier);
        Some(vec![s.nearest_neighbor, ft, st, s.e_measure, s.dcg, s.average_precision])
    };
    let mean = mean_of_queries(distances, labels, averaging, 6, query)?;
    Ok(MeanScores { nn: mean[0], ft: mean[1], st: mean[2], e: mean[3], dcg: mean[4], map: mean[5] })
}

/// Mean precision at `n` recalls spread evenly from 0 to 1: for each query the largest precision at that or a higher
/// recall (interpolated precision, as for 11 points in information retrieval).
///
/// # Errors
/// [`RetrievalError::LabelCount`], [`RetrievalError::NothingToScore`].
pub fn precision_recall(
    distances: &DistanceMatrix,
    labels: &Labels,
    averaging: Averaging,
    n: usize,
) -> Result<Vec<f64>, RetrievalError> {
    let query = |i: usize| {
        let class = labels.class(i);
        let relevant = labels.size(class) - 1;
        let mut precisions = Vec::with_capacity(relevant);
        for (at, &other) in rank(distances, i).order.iter().enumerate() {
            if labels.class(other) == class {
                precisions.push((precisions.len() + 1) as f64 / (at + 1) as f64);
            }
        }
        let mut best = 0.0f64;
        for precision in precisions.iter_mut().rev() {
            best = best.max(*precision);
            *precision = best;
        }
        // The fewest hits that make the recall.
        let hits = |step: usize| (step * relevant).div_ceil(n.max(2) - 1).max(1);
        Some((0..n).map(|step| precisions[hits(step) - 1]).collect())
    };
    mean_of_queries(distances, labels, averaging, n, query)
}

/// The mean of what `query` says of each shape that is scored as a query.
fn mean_of_queries(
    distances: &DistanceMatrix,
    labels: &Labels,
    averaging: Averaging,
    length: usize,
    query: impl Fn(usize) -> Option<Vec<f64>>,
) -> Result<Vec<f64>, RetrievalError> {
    let n_points = distances.n_points();
    if labels.n_points() != n_points {
        return Err(RetrievalError::LabelCount { n_labels: labels.n_points(), n_points });
    }
    let (mut sum, mut total) = (vec![0.0; length], 0.0);
    for i in (0..n_points).filter(|&i| labels.is_query(i)) {
        let weight = match averaging {
            Averaging::Micro => 1.0,
            Averaging::Macro => 1.0 / labels.size(labels.class(i)) as f64,
        };
        if let Some(values) = query(i) {
            sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += weight * value);
            total += weight;
        }
    }
    match total > 0.0 {
        true => Ok(sum.into_iter().map(|sum| sum / total).collect()),
        false => Err(RetrievalError::NothingToScore { n_points, n_classes: labels.classes().len() }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate;

    /// Class `a` of four on the left, `b` of three on the right, one of `b` astray among `a`.
    fn example() -> (DistanceMatrix, Labels) {
        let places = [0.0f64, 1.0, 2.0, 3.5, 1.4, 50.0, 51.5];
        let distances = DistanceMatrix::from_pairs(7, |i, j| (places[i] - places[j]).abs()).unwrap();
        (distances, Labels::new(&["a", "a", "a", "a", "b", "b", "b"]))
    }

    #[test]
    fn micro_means_are_those_of_an_evaluation_and_macro_ones_weigh_classes_alike() {
        let (distances, labels) = example();
        let micro = mean_scores(&distances, &labels, Averaging::Micro).unwrap();
        let whole = evaluate(&distances, &labels, 1).unwrap();
        assert_eq!([micro.nn, micro.ft, micro.map], [whole.nn, whole.ft, whole.map]);
        let equal = mean_scores(&distances, &labels, Averaging::Macro).unwrap();
        // Right nearest neighbours: of a the first and the last, of b the two far ones.
        assert!((micro.nn - 4.0 / 7.0).abs() < 1e-15, "{}", micro.nn);
        assert!((equal.nn - (0.5 + 2.0 / 3.0) / 2.0).abs() < 1e-15, "{}", equal.nn);
    }

    #[test]
    fn precision_falls_with_recall_and_is_one_where_all_is_right() {
        let (distances, labels) = example();
        let curve = precision_recall(&distances, &labels, Averaging::Micro, 11).unwrap();
        assert!(curve.windows(2).all(|w| w[0] >= w[1]) && curve[0] < 1.0 && curve[10] > 0.0);
        let apart = DistanceMatrix::from_pairs(6, |i, j| if i / 3 == j / 3 { 1.0 } else { 9.0 }).unwrap();
        let labels = Labels::new(&["a", "a", "a", "b", "b", "b"]);
        assert_eq!(precision_recall(&apart, &labels, Averaging::Macro, 5), Ok(vec![1.0; 5]));
    }

    #[test]
    fn nothing_to_score_is_said() {
        let distances = DistanceMatrix::from_pairs(2, |_, _| 1.0).unwrap();
        let labels = Labels::new(&["a", "a"]);
        let fault = mean_scores(&distances, &labels, Averaging::Micro).unwrap_err();
        assert_eq!(fault, RetrievalError::NothingToScore { n_points: 2, n_classes: 1 });
        let labels = Labels::new(&["a"]);
        let fault = precision_recall(&distances, &labels, Averaging::Micro, 11).unwrap_err();
        assert_eq!(fault, RetrievalError::LabelCount { n_labels: 1, n_points: 2 });
    }
}
