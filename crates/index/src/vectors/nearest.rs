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

/// The `k` nearest rows offered so far, independent of the order of offers.
#[derive(Debug, Clone)]
pub(crate) struct Nearest {
    k: usize,
    /// The farthest is on top.
    heap: BinaryHeap<Hit>,
}

impl Nearest {
    pub(crate) fn new(k: usize) -> Self {
        Self { k, heap: BinaryHeap::with_capacity(k.min(1 << 16) + 1) }
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
        } else if let Some(mut last) = self.heap.peek_mut()
            && hit < *last
        {
            *last = hit;
        }
    }

    /// Offers rows with their squared distances.
    pub(crate) fn offer_all(&mut self, slots: &[u32], sqs: &[f32]) {
        let mut bound = self.bound();
        for (slot, sq) in slots.iter().zip(sqs) {
            if *sq <= bound {
                self.offer(Hit { sq: *sq, slot: *slot });
                bound = self.bound();
            }
        }
    }

    pub(crate) fn join(mut self, other: Self) -> Self {
        other.heap.into_iter().for_each(|hit| self.offer(hit));
        self
    }

    /// Nearest first.
    pub(crate) fn into_sorted(self) -> Vec<Hit> {
        self.heap.into_sorted_vec()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_the_nearest_sorted_for_any_order_of_offers() {
        let sqs = [5.0, 1.0, 3.0, 1.0, 9.0, 0.5, 3.0];
        let expected = [(0.5, 5), (1.0, 1), (1.0, 3), (3.0, 2)];
        for turn in 0..sqs.len() {
            let [mut a, mut b] = [Nearest::new(4), Nearest::new(4)];
            for i in 0..sqs.len() {
                let slot = (i + turn) % sqs.len();
                let part = if i % 2 == 0 { &mut a } else { &mut b };
                part.offer_all(&[slot as u32], &[sqs[slot]]);
            }
            let kept: Vec<_> = a.join(b).into_sorted().iter().map(|hit| (hit.sq, hit.slot)).collect();
            assert_eq!(kept, expected);
        }
        let mut none = Nearest::new(0);
        none.offer_all(&[1], &[0.0]);
        assert!(none.into_sorted().is_empty());
    }
}
