//! Shapes of one cell, as they are stored.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::floats::Floats;
use crate::texts::Texts;

/// Some shapes of one cell.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Part {
    pub(crate) ids: Texts,
    pub(crate) classes: Texts,
    pub(crate) rows: Floats,
}

impl Part {
    /// The padded vectors.
    pub(crate) fn rows(&self) -> &[f32] {
        &self.rows.0
    }

    /// Names, classes and padded vectors.
    pub(crate) fn shapes(&self) -> impl Iterator<Item = (&str, &str, &[f32])> {
        let n = self.rows.0.len() / self.ids.len().max(1);
        let rows = self.rows.0.chunks(n.max(1));
        self.ids.iter().zip(self.classes.iter()).zip(rows).map(|((id, class), row)| (id, class, row))
    }

    pub(crate) fn row(&self, i: usize) -> &[f32] {
        let n = self.rows.0.len() / self.ids.len();
        &self.rows.0[i * n..][..n]
    }

    /// Brings the shapes into an order: `order[i]` becomes the `i`-th. Vectors have `n` numbers.
    pub(crate) fn sort(&mut self, order: &[usize], n: usize) {
        self.ids = order.iter().map(|i| self.ids.get(*i)).collect();
        self.classes = order.iter().map(|i| self.classes.get(*i)).collect();
        // In place, one cycle of the permutation after the other: the vectors of a million shapes take a gigabyte.
        let rows = &mut self.rows.0;
        let mut is_done = vec![false; order.len()];
        for first in 0..order.len() {
            if is_done[first] {
                continue;
            }
            let start = rows[first * n..][..n].to_vec();
            let mut to = first;
            loop {
                is_done[to] = true;
                let from = order[to];
                if from == first {
                    rows[to * n..][..n].copy_from_slice(&start);
                    break;
                }
                rows.copy_within(from * n..(from + 1) * n, to * n);
                to = from;
            }
        }
    }

    /// Some of the shapes.
    pub(crate) fn slice(&self, range: Range<usize>) -> Self {
        let mut some = Self::default();
        for i in range {
            some.push(self.ids.get(i), self.classes.get(i), self.row(i));
        }
        some
    }

    pub(crate) fn push(&mut self, id: &str, class: &str, row: &[f32]) {
        self.ids.push(id);
        self.classes.push(class);
        self.rows.0.extend_from_slice(row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_sorted_in_place() {
        let mut part = Part::default();
        (0..7).for_each(|i| part.push(&i.to_string(), &format!("c{i}"), &[i as f32, 0.5]));
        let order = [3, 1, 0, 6, 5, 4, 2];
        part.sort(&order, 2);
        for (i, from) in order.into_iter().enumerate() {
            assert_eq!((part.ids.get(i), part.classes.get(i)), (&*from.to_string(), &*format!("c{from}")));
            assert_eq!(part.rows()[2 * i..][..2], [from as f32, 0.5]);
        }
    }
}
