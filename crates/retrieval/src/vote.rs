//! Classification by votes of neighbors, with a threshold for unknown classes.

use serde::{Deserialize, Serialize};

use crate::Neighbor;

/// The distance beyond which a shape is considered to belong to none of the known classes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct UnknownThreshold {
    /// A shape whose nearest neighbor is farther than this is unknown.
    pub distance: f64,
    /// Share of the labelled shapes that would be called unknown although their class is present.
    pub missed: f64,
    /// Share of the labelled shapes that would be assigned a class if their own were absent.
    pub mistaken: f64,
}

impl UnknownThreshold {
    /// The threshold that separates labelled shapes best: `own` holds distances from shapes to the nearest other
    /// shape of their class, `foreign` distances to the nearest shape of any other class.
    ///
    /// Minimizes the sum of the two error rates; if a range of thresholds does, returns its middle. Without foreign
    /// distances, returns twice the largest own distance. Returns `None` without own distances.
    pub fn from_distances(own: &[f64], foreign: &[f64]) -> Option<Self> {
        let sorted = |distances: &[f64]| {
            let mut sorted: Vec<f64> = distances.iter().copied().filter(|d| d.is_finite()).collect();
            sorted.sort_by(f64::total_cmp);
            sorted
        };
        let (own, foreign) = (sorted(own), sorted(foreign));
        let largest = *own.last()?;
        if foreign.is_empty() {
            return Some(Self { distance: 2.0 * largest, missed: 0.0, mistaken: 0.0 });
        }
        let missed = |t: f64| (own.len() - own.partition_point(|d| *d <= t)) as f64 / own.len() as f64;
        let mistaken = |t: f64| foreign.partition_point(|d| *d <= t) as f64 / foreign.len() as f64;
        let mut steps: Vec<f64> = own.iter().chain(&foreign).copied().collect();
        steps.sort_by(f64::total_cmp);
        steps.dedup();
        // Error rates are constant between two steps.
        let cost = |step: &f64| missed(*step) + mistaken(*step);
        let (mut best, mut least) = (0, f64::INFINITY);
        for (i, step) in steps.iter().enumerate() {
            if cost(step) < least {
                (best, least) = (i, cost(step));
            }
        }
        let end = steps.get(best + 1).map_or(2.0 * steps[best], |next| *next);
        let distance = 0.5 * (steps[best] + end);
        Some(Self { distance, missed: missed(distance), mistaken: mistaken(distance) })
    }
}

/// The outcome of a vote on the class of a shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Vote {
    /// Number of neighbors that voted.
    pub voters: usize,
    /// The votes for every class, the winner first, then by share.
    pub tally: Vec<Tally>,
}

impl Vote {
    /// The winning class; `None` if no neighbor is near enough.
    pub fn class(&self) -> Option<usize> {
        self.tally.first().map(|winner| winner.class)
    }
}

/// The votes for one class.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tally {
    /// The class.
    pub class: usize,
    /// Number of votes.
    pub votes: usize,
    /// Weighted share of the votes, in 0..=1.
    pub share: f64,
}

/// Lets the `k` nearest neighbors vote on a class.
///
/// A neighbor at distance `d` has the weight `(1 - (d / t)²)²` with `t` the `limit`; neighbors beyond it have
/// no vote. Without a limit all votes weigh the same. Ties go to the class of the nearest neighbor.
///
/// `neighbors` are in ascending order of distance; `class_of` maps the index of a shape to its class.
pub fn vote(neighbors: &[Neighbor], class_of: impl Fn(usize) -> usize, k: usize, limit: Option<f64>) -> Vote {
    let weight = |distance: f64| match limit {
        Some(limit) if distance > limit => None,
        Some(limit) if limit > 0.0 => Some((1.0 - (distance / limit).powi(2)).powi(2)),
        _ => Some(1.0),
    };
    let voters: Vec<(usize, f64)> = neighbors
        .iter()
        .take(k)
        .filter_map(|neighbor| Some((class_of(neighbor.index), weight(neighbor.distance)?)))
        .collect();
    let total: f64 = voters.iter().map(|(_, weight)| weight).sum();
    let mut tally: Vec<Tally> = Vec::new();
    for &(class, _) in &voters {
        if tally.iter().any(|other| other.class == class) {
            continue;
        }
        let of = voters.iter().filter(|(other, _)| *other == class);
        let votes = of.clone().count();
        let share = if total > 0.0 {
            of.map(|(_, weight)| weight).sum::<f64>() / total
        } else {
            votes as f64 / voters.len() as f64
        };
        tally.push(Tally { class, votes, share });
    }
    // The first of equals is the nearest; rounding absorbs differences between sums taken in another order.
    tally.sort_by_key(|of| std::cmp::Reverse((of.share * 1e12).round() as i64));
    Vote { voters: voters.len(), tally }
}
