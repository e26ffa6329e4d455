//! The class of a shape by the votes of its neighbours, or none.

use linalg::DistanceMatrix;
use serde::{Deserialize, Serialize};

use crate::{Labels, Neighbor, rank};

/// How far a shape may be from all others and still be of one of their classes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct UnknownThreshold {
    /// A shape whose nearest neighbour is farther is unknown.
    pub distance: f64,
    /// Share of the shapes that would be called unknown although their class is there.
    pub missed: f64,
    /// Share of the shapes that would be given a class if their own were not there.
    pub mistaken: f64,
}

impl UnknownThreshold {
    /// The threshold that the labelled shapes themselves suggest, each asked about as if it was new: `own` holds the
    /// distances from shapes to the nearest other one of their class, `foreign` those to the nearest of any
    /// other class, which would be nearest if the own was missing.
    ///
    /// It makes the sum of the two error rates least; of a range of such thresholds it is the middle. Without
    /// foreign distances it is twice the largest own one. `None` without own ones: nothing is known then
    /// of how far a shape of a class may be.
    #[must_use]
    pub fn of(own: &[f64], foreign: &[f64]) -> Option<Self> {
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
        // Between two steps nothing changes.
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

    /// The threshold suggested by all shapes of a matrix of distances, see [`of`](Self::of). Shapes alone in
    /// their class have no own distance.
    #[must_use]
    pub fn leave_one_out(distances: &DistanceMatrix, labels: &Labels) -> Option<Self> {
        let (mut own, mut foreign) = (Vec::new(), Vec::new());
        for i in 0..distances.n_points() {
            let ranking = rank(distances, i);
            let nearest = |same: bool| {
                let is = |j: &usize| (labels.class(*j) == labels.class(i)) == same;
                ranking.order.iter().position(is).map(|at| ranking.distances[at])
            };
            own.extend(nearest(true));
            foreign.extend(nearest(false));
        }
        Self::of(&own, &foreign)
    }
}

/// What the neighbours of a shape say of its class.
#[derive(Debug, Clone, PartialEq)]
pub struct Vote {
    /// The class of most votes; `None` when nothing is near.
    pub class: Option<usize>,
    /// Share of the votes that it has, each weighted by how near the neighbour is, 0 to 1.
    pub confidence: f64,
    /// Neighbours of that class among those who voted.
    pub votes: usize,
    /// Neighbours who voted.
    pub voters: usize,
}

/// The class that the `k` nearest vote for.
///
/// A neighbour at distance `d` has the weight `(1 - (d / t)²)²` with `t` the threshold, so none beyond it has a vote;
/// without a threshold all weigh the same. The nearest neighbour's class wins a draw.
///
/// `neighbors` are in ascending order of distance; `class_of` gives the class of a shape by its index.
#[must_use]
pub fn vote(
    neighbors: &[Neighbor],
    class_of: impl Fn(usize) -> usize,
    k: usize,
    threshold: Option<UnknownThreshold>,
) -> Vote {
    let weight = |distance: f64| match threshold {
        Some(threshold) if distance > threshold.distance => None,
        Some(threshold) if threshold.distance > 0.0 => {
            Some((1.0 - (distance / threshold.distance).powi(2)).powi(2))
        }
        _ => Some(1.0),
    };
    let voters: Vec<(usize, f64)> = neighbors
        .iter()
        .take(k)
        .filter_map(|neighbor| Some((class_of(neighbor.index), weight(neighbor.distance)?)))
        .collect();
    let total: f64 = voters.iter().map(|(_, weight)| weight).sum();
    let of = |class: usize| voters.iter().filter(move |(other, _)| *other == class);
    let mut winner = Vote { class: None, confidence: 0.0, votes: 0, voters: voters.len() };
    for &(class, _) in &voters {
        let share = if total > 0.0 {
            of(class).map(|(_, weight)| weight).sum::<f64>() / total
        } else {
            of(class).count() as f64 / voters.len() as f64
        };
        // The first of equals is the nearest; sums in another order may differ in the last bit.
        if winner.class.is_none() || share > winner.confidence + 1e-12 {
            winner = Vote { class: Some(class), confidence: share, votes: of(class).count(), ..winner };
        }
    }
    winner
}

#[cfg(test)]
mod tests {
    use super::*;

    fn neighbors(distances: &[f64]) -> Vec<Neighbor> {
        distances.iter().enumerate().map(|(index, &distance)| Neighbor { index, distance }).collect()
    }

    fn threshold(distance: f64) -> Option<UnknownThreshold> {
        Some(UnknownThreshold { distance, missed: 0.0, mistaken: 0.0 })
    }

    #[test]
    fn the_threshold_parts_own_from_foreign_distances() {
        let found = UnknownThreshold::of(&[1.0, 2.0, 1.5], &[4.0, 6.0]).unwrap();
        assert_eq!(found, UnknownThreshold { distance: 3.0, missed: 0.0, mistaken: 0.0 });
        // Overlapping: giving up the outlier costs less than taking the foreigners for friends.
        let found = UnknownThreshold::of(&[1.0, 1.0, 1.0, 9.0], &[5.0, 6.0]).unwrap();
        assert_eq!((found.distance, found.missed, found.mistaken), (3.0, 0.25, 0.0));
        assert_eq!(UnknownThreshold::of(&[], &[1.0]), None);
        assert_eq!(UnknownThreshold::of(&[1.0, 2.0], &[]).unwrap().distance, 4.0);
    }

    #[test]
    fn leave_one_out_asks_every_shape() {
        let places = [0.0f64, 1.0, 2.5, 10.0, 11.0, 30.0];
        let distances = DistanceMatrix::from_pairs(6, |i, j| (places[i] - places[j]).abs()).unwrap();
        let labels = Labels::new(&["a", "a", "a", "b", "b", "c"]);
        let found = UnknownThreshold::leave_one_out(&distances, &labels).unwrap();
        // Own: 1, 1, 1.5, 1, 1; foreign: 10, 9, 7.5, 7.5, 8.5, 19.
        assert_eq!(found, UnknownThreshold { distance: 4.5, missed: 0.0, mistaken: 0.0 });
    }

    #[test]
    fn near_neighbours_outvote_many_far_ones() {
        let class = |i: usize| usize::from(i > 0);
        let near = neighbors(&[0.1, 0.9, 0.95]);
        let plain = vote(&near, class, 3, None);
        assert_eq!((plain.class, plain.votes, plain.voters), (Some(1), 2, 3));
        assert!((plain.confidence - 2.0 / 3.0).abs() < 1e-15);
        let weighted = vote(&near, class, 3, threshold(1.0));
        assert_eq!((weighted.class, weighted.votes), (Some(0), 1));
        assert!(weighted.confidence > 0.9);
    }

    #[test]
    fn nothing_near_is_unknown_and_the_nearest_wins_a_draw() {
        let far = vote(&neighbors(&[2.0, 3.0]), |i| i, 2, threshold(1.0));
        assert_eq!(far, Vote { class: None, confidence: 0.0, votes: 0, voters: 0 });
        assert_eq!(vote(&neighbors(&[2.0, 3.0]), |i| 7 - i, 2, None).class, Some(7));
        assert_eq!(vote(&neighbors(&[0.0, 0.0]), |i| i, 2, threshold(0.0)).class, Some(0));
        assert_eq!(vote(&[], |i| i, 3, None).class, None);
    }
}
