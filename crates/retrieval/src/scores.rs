//! Retrieval scores of one query, their means, and precision-recall curves.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::{Labels, Neighbor, Rankings, RetrievalError};

/// Retrieval scores in 0..=1, of one query or averaged over queries, in the conventions of the Princeton shape
/// benchmark's `psbTable`.
///
/// `C` is the number of relevant shapes: the size of the query's class minus the query itself.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct Scores {
    /// Nearest neighbor: 1 if the nearest shape is relevant, else 0.
    pub nn: f64,
    /// First tier: share of the relevant shapes among the first `C`.
    pub ft: f64,
    /// Second tier: share of the relevant shapes among the first `2 C`.
    pub st: f64,
    /// E-measure: harmonic mean of precision and recall at rank `min(32, n - 1)`. Cannot reach 1 if `C` is
    /// smaller than that rank.
    pub e: f64,
    /// Normalized discounted cumulative gain: `g_1 + sum_{r >= 2} g_r / log2 r` over its best possible value.
    pub dcg: f64,
    /// Average precision: mean of the precision at the rank of each relevant shape.
    pub map: f64,
}

impl Scores {
    /// The scores of the shape `query`, given its ranking of all other shapes. Returns `None` if no other shape
    /// is in its class.
    pub fn for_query(ranking: &[Neighbor], query: usize, labels: &Labels) -> Option<Self> {
        let class = labels.class(query);
        let relevant = labels.size(class) - 1;
        if relevant == 0 {
            return None;
        }
        let hits: Vec<bool> = ranking.iter().map(|other| labels.class(other.index) == class).collect();
        let count = |rank: usize| hits.iter().take(rank).filter(|hit| **hit).count() as f64;
        let c = relevant as f64;
        let page = hits.len().min(32);
        let (precision, recall) = (count(page) / page as f64, count(page) / c);
        let discount = |rank: usize| if rank == 1 { 1.0 } else { 1.0 / (rank as f64).log2() };
        let (mut gain, mut found, mut precisions) = (0.0, 0.0, 0.0);
        for (i, _) in hits.iter().enumerate().filter(|(_, hit)| **hit) {
            found += 1.0;
            gain += discount(i + 1);
            precisions += found / (i + 1) as f64;
        }
        let both = precision + recall;
        Some(Self {
            nn: count(1),
            ft: count(relevant) / c,
            st: count(2 * relevant) / c,
            e: if both > 0.0 { 2.0 * precision * recall / both } else { 0.0 },
            dcg: gain / (1..=relevant).map(discount).sum::<f64>(),
            map: precisions / c,
        })
    }

    /// Number of scores.
    pub const N: usize = 6;

    /// NN, FT, ST, E, DCG and mAP.
    pub fn to_array(self) -> [f64; Self::N] {
        [self.nn, self.ft, self.st, self.e, self.dcg, self.map]
    }

    pub(crate) fn from_array([nn, ft, st, e, dcg, map]: [f64; Self::N]) -> Self {
        Self { nn, ft, st, e, dcg, map }
    }
}

/// The scores of all queries of a collection.
#[derive(Debug, Clone, PartialEq)]
pub struct QueryScores {
    /// The queries in ascending order, with their scores.
    pub of: Vec<(usize, Scores)>,
}

impl QueryScores {
    /// Scores every shape whose class has more than two members as a query against all others.
    ///
    /// # Errors
    /// [`RetrievalError::LabelCount`], [`RetrievalError::NothingToScore`].
    pub fn new(rankings: &impl Rankings, labels: &Labels) -> Result<Self, RetrievalError> {
        let score = |i: usize| Scores::for_query(&rankings.ranking(i), i, labels);
        Ok(Self { of: of_queries(rankings.n_points(), labels, score)? })
    }

    /// The mean scores over the queries.
    pub fn mean(&self) -> Scores {
        let mut sum = [0.0; Scores::N];
        for (_, scores) in &self.of {
            sum.iter_mut().zip(scores.to_array()).for_each(|(sum, score)| *sum += score);
        }
        Scores::from_array(sum.map(|sum| sum / self.of.len() as f64))
    }
}

/// Mean interpolated precision at `n` recalls spread evenly from 0 to 1: the precision of a query at a recall is
/// its largest precision at that or any higher recall.
///
/// # Errors
/// [`RetrievalError::LabelCount`], [`RetrievalError::NothingToScore`].
pub fn precision_recall(
    rankings: &impl Rankings,
    labels: &Labels,
    n: usize,
) -> Result<Vec<f64>, RetrievalError> {
    let query = |i: usize| {
        let class = labels.class(i);
        let relevant = labels.size(class) - 1;
        let mut precisions = Vec::with_capacity(relevant);
        for (at, other) in rankings.ranking(i).iter().enumerate() {
            if labels.class(other.index) == class {
                precisions.push((precisions.len() + 1) as f64 / (at + 1) as f64);
            }
        }
        let mut best = 0.0f64;
        for precision in precisions.iter_mut().rev() {
            best = best.max(*precision);
            *precision = best;
        }
        // The smallest number of hits that reaches the recall.
        let hits = |step: usize| (step * relevant).div_ceil(n.max(2) - 1).max(1);
        Some((0..n).map(|step| precisions[hits(step) - 1]).collect::<Vec<f64>>())
    };
    let curves = of_queries(rankings.n_points(), labels, query)?;
    let mean = |step: usize| curves.iter().map(|(_, curve)| curve[step]).sum::<f64>() / curves.len() as f64;
    Ok((0..n).map(mean).collect())
}

/// What `query` returns for each shape that is scored as a query, in parallel.
fn of_queries<T: Send>(
    n_points: usize,
    labels: &Labels,
    query: impl Fn(usize) -> Option<T> + Sync,
) -> Result<Vec<(usize, T)>, RetrievalError> {
    if labels.n_points() != n_points {
        return Err(RetrievalError::LabelCount { n_labels: labels.n_points(), n_points });
    }
    let queries: Vec<usize> = (0..n_points).filter(|&i| labels.is_query(i)).collect();
    let found: Vec<_> = queries.into_par_iter().filter_map(|i| Some((i, query(i)?))).collect();
    match found.is_empty() {
        true => Err(RetrievalError::NothingToScore { n_points, n_classes: labels.classes().len() }),
        false => Ok(found),
    }
}
