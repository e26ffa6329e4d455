//! The k nearest of many rows.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// A row and its squared distance from the query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hit {
    /// Squared distance.
    pub(crate) sq: f32,
    /// Number of the row.
    pub(crate) slot: u32,
}

impl Eq for Hit {}

impl Ord for Hit {
    fn cmp(&self, other: &Self) -> Ordering {
        self.sq.total_cmp(&other.sq).then(self.slot.cmp(&other.slot))
    }
}

impl PartialOrd for Hit {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The `k` nearest rows offered so far, and all rows as far away as the last of them, so that the caller can decide
/// between equals. Independent of the order of offers.
#[derive(Debug, Clone)]
pub(crate) struct Nearest {
    k: usize,
    /// The farthest is on top.
    heap: BinaryHeap<Hit>,
    /// Further rows at the distance of the farthest.
    ties: Vec<Hit>,
}

impl Nearest {
    pub(crate) fn new(k: usize) -> Self {
        Self { k, heap: BinaryHeap::with_capacity(k.min(1 << 16) + 1), ties: Vec::new() }
    }

    /// Rows beyond this squared distance are dropped.
    pub(crate) fn bound(&self) -> f32 {
        match self.heap.peek() {
            Some(last) if self.heap.len() >= self.k => last.sq,
            _ if self.k == 0 => f32::NEG_INFINITY,
            _ => f32::INFINITY,
        }
    }

    pub(crate) fn offer(&mut self, hit: Hit) {
        if self.heap.len() < self.k {
            self.heap.push(hit);
            return;
        }
        let Some(mut last) = self.heap.peek_mut() else { return };
        match hit.sq.total_cmp(&last.sq) {
            Ordering::Greater => {}
            Ordering::Equal => self.ties.push(hit),
            Ordering::Less => {
                let dropped = std::mem::replace(&mut *last, hit);
                drop(last);
                match self.bound() == dropped.sq {
                    true => self.ties.push(dropped),
                    false => self.ties.clear(),
                }
            }
        }
    }

    /// Offers rows with their squared distances; `first` is the number of the first row.
    pub(crate) fn offer_all(&mut self, first: u32, sqs: &[f32]) {
        let mut bound = self.bound();
        for (slot, sq) in (first..).zip(sqs) {
            if *sq <= bound {
                self.offer(Hit { sq: *sq, slot });
                bound = self.bound();
            }
        }
    }

    pub(crate) fn join(mut self, other: Self) -> Self {
        other.heap.into_iter().chain(other.ties).for_each(|hit| self.offer(hit));
        self
    }

    /// At least `k` hits if there are as many, in any order.
    pub(crate) fn into_hits(self) -> impl Iterator<Item = Hit> {
        self.heap.into_iter().chain(self.ties)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_nearest_and_what_equals_the_last_for_any_order_of_offers() {
        let sqs = [5.0, 1.0, 3.0, 1.0, 9.0, 0.5, 3.0, 3.0];
        for (k, expected) in [
            (0, vec![]),
            (2, vec![(0.5, 5), (1.0, 1), (1.0, 3)]),
            (4, vec![(0.5, 5), (1.0, 1), (1.0, 3), (3.0, 2), (3.0, 6), (3.0, 7)]),
        ] {
            for turn in 0..sqs.len() {
                let [mut a, mut b] = [Nearest::new(k), Nearest::new(k)];
                for i in 0..sqs.len() {
                    let slot = (i + turn) % sqs.len();
                    let part = if i % 2 == 0 { &mut a } else { &mut b };
                    part.offer_all(slot as u32, &[sqs[slot]]);
                }
                let mut kept: Vec<_> = a.join(b).into_hits().collect();
                kept.sort();
                assert_eq!(kept.iter().map(|hit| (hit.sq, hit.slot)).collect::<Vec<_>>(), expected);
            }
        }
    }
}
