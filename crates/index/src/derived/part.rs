//! Shapes of one cell, as they are stored.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::store::Floats;
use crate::texts::Texts;
use crate::vectors::Rows;

/// Some shapes of one cell.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Part {
    pub(crate) ids: Texts,
    pub(crate) classes: Texts,
    pub(super) rows: Floats,
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

    pub(crate) fn in_cell<'a>(&'a self, cell: &'a u32) -> Rows<'a> {
        let cells = std::slice::from_ref(cell);
        Rows { rows: self.rows(), ids: &self.ids, classes: &self.classes, cells }
    }

    /// Brings the shapes into an order: `order[i]` becomes the `i`-th. Vectors have `n` numbers.
    pub(super) fn sort(&mut self, order: &[usize], n: usize) {
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
    pub(super) fn slice(&self, range: Range<usize>) -> Self {
        let mut some = Self::default();
        for i in range {
            some.push(self.ids.get(i), self.classes.get(i), self.in_cell(&0).row(i));
        }
        some
    }

    pub(super) fn push(&mut self, id: &str, class: &str, row: &[f32]) {
        self.ids.push(id);
        self.classes.push(class);
        self.rows.0.extend_from_slice(row);
    }
}
