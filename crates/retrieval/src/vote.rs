//! Classification by votes of neighbors.

use crate::Neighbor;

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
