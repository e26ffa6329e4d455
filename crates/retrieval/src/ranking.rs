//! Ranked lists and the scores of one query.

use linalg::DistanceMatrix;

use crate::Labels;

/// All other shapes in order of distance from a query.
#[derive(Debug, Clone, PartialEq)]
pub struct Ranking {
    /// Indices of the other shapes, nearest first; ties by index.
    pub order: Vec<usize>,
    /// Their distances, ascending.
    pub distances: Vec<f64>,
}

/// Ranks all shapes but `query` by distance from it.
#[must_use]
pub fn rank(distances: &DistanceMatrix, query: usize) -> Ranking {
    let row = distances.row(query);
    let mut order: Vec<usize> = (0..row.len()).filter(|&i| i != query).collect();
    order.sort_by(|&i, &j| row[i].total_cmp(&row[j]).then(i.cmp(&j)));
    let distances = order.iter().map(|&i| row[i]).collect();
    Ranking { order, distances }
}

/// The scores of one query, in the conventions of the Princeton shape benchmark's `psbTable`.
///
/// `C` is the number of relevant shapes: the size of the query's class less the query itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct QueryScores {
    /// 1 if the nearest shape is relevant, else 0.
    pub nearest_neighbor: f64,
    /// Share of the relevant shapes among the first `C`.
    pub first_tier: f64,
    /// Share of the relevant shapes among the first `2 C`.
    pub second_tier: f64,
    /// Harmonic mean of precision and recall at rank `min(32, N - 1)`; cannot reach 1 where `C` is less.
    pub e_measure: f64,
    /// Discounted cumulative gain `g_1 + sum_{r >= 2} g_r / log2 r` over its best possible value.
    pub dcg: f64,
    /// Mean of the precision at the rank of every relevant shape.
    pub average_precision: f64,
}

impl QueryScores {
    /// Scores the ranking of the query `query`; `None` when nothing else is of its class.
    #[must_use]
    pub fn new(ranking: &Ranking, query: usize, labels: &Labels) -> Option<Self> {
        let class = labels.class(query);
        let relevant = labels.size(class) - 1;
        if relevant == 0 {
            return None;
        }
        let hits: Vec<bool> = ranking.order.iter().map(|&i| labels.class(i) == class).collect();
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
        Some(Self {
            nearest_neighbor: count(1),
            first_tier: count(relevant) / c,
            second_tier: count(2 * relevant) / c,
            e_measure: if precision + recall > 0.0 {
                2.0 * precision * recall / (precision + recall)
            } else {
                0.0
            },
            dcg: gain / (1..=relevant).map(discount).sum::<f64>(),
            average_precision: precisions / c,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shapes on a line at these places; the distance is the difference.
    fn line(places: &[f64]) -> DistanceMatrix {
        DistanceMatrix::from_pairs(places.len(), |i, j| (places[i] - places[j]).abs()).unwrap()
    }

    #[test]
    fn scores_follow_their_definitions_on_a_worked_example() {
        // From shape 0 the order is b a a b a: relevant at ranks 2, 3 and 5 of 5.
        let distances = line(&[0.0, 1.0, 2.0, 3.0, 4.0, 5.0]);
        let labels = Labels::new(&["a", "b", "a", "a", "b", "a"]);
        let ranking = rank(&distances, 0);
        assert_eq!(ranking.order, [1, 2, 3, 4, 5]);
        let scores = QueryScores::new(&ranking, 0, &labels).unwrap();
        assert_eq!(scores.nearest_neighbor, 0.0);
        assert!((scores.first_tier - 2.0 / 3.0).abs() < 1e-15);
        assert_eq!(scores.second_tier, 1.0);
        assert!((scores.average_precision - (1.0 / 2.0 + 2.0 / 3.0 + 3.0 / 5.0) / 3.0).abs() < 1e-15);
        let gain = 1.0 + 1.0 / 3f64.log2() + 1.0 / 5f64.log2();
        let ideal = 1.0 + 1.0 + 1.0 / 3f64.log2();
        assert!((scores.dcg - gain / ideal).abs() < 1e-15);
        // At rank 5: precision 3/5, recall 1.
        assert!((scores.e_measure - 0.75).abs() < 1e-15);
    }

    #[test]
    fn ties_go_to_the_lower_index() {
        assert_eq!(rank(&line(&[0.0, 1.0, -1.0, 1.0]), 0).order, [1, 2, 3]);
    }

    #[test]
    fn e_measure_of_a_perfect_list_is_limited_by_the_page() {
        // 30 shapes, one class of 15: 14 relevant among the 29 on the page.
        let places: Vec<f64> = (0..30).map(f64::from).collect();
        let names: Vec<&str> = (0..30).map(|i| if i < 15 { "a" } else { "b" }).collect();
        let scores = QueryScores::new(&rank(&line(&places), 0), 0, &Labels::new(&names)).unwrap();
        assert_eq!(scores.first_tier, 1.0);
        assert!((scores.e_measure - 0.651).abs() < 1e-3);
    }

    #[test]
    fn a_class_of_one_has_no_scores() {
        assert_eq!(QueryScores::new(&rank(&line(&[0.0, 1.0]), 0), 0, &Labels::new(&["a", "b"])), None);
    }
}
