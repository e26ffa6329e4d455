//! The fused vectors of all shapes.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::Range;

use rayon::prelude::*;
use retrieval::Neighbor;

use super::kernels::{least_loss, losses_into, padded};

/// Rows measured together.
const BLOCK: usize = 256;

/// Blocks in one parallel task, at least.
const TASK: usize = 8;

/// What is known of a distance. At the same distance blocks and rows come first, so that equals are all measured before the
/// first of them is found.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Known {
    /// A lower bound for all rows of a block.
    Block,
    /// A lower bound for a row.
    Row,
    /// The distance of a row.
    Distance,
}

/// The fused vectors of all shapes of an index, in ascending order of their names.
#[derive(Debug, Default)]
pub struct VectorTable {
    ids: Vec<Box<str>>,
    dim: usize,
    /// Vectors with zeros behind them, which kernels need.
    rows: Vec<f32>,
}

impl VectorTable {
    /// Adds a vector. All have the same length.
    pub fn push(&mut self, id: &str, vector: &[f32]) {
        self.dim = vector.len();
        self.ids.push(id.into());
        self.rows.extend_from_slice(vector);
        self.rows.resize(self.ids.len() * padded(self.dim), 0.0);
    }

    /// Number of shapes.
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Length of a vector; 0 if there are none.
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The name of a shape.
    pub fn id(&self, i: usize) -> &str {
        &self.ids[i]
    }

    /// The vector of a shape.
    pub fn vector(&self, i: usize) -> &[f32] {
        &self.rows(i..i + 1)[..self.dim]
    }

    /// Padded rows.
    pub(super) fn rows(&self, shapes: Range<usize>) -> &[f32] {
        let n = padded(self.dim);
        &self.rows[shapes.start * n..shapes.end * n]
    }

    /// The numbers and distances of the `k` vectors nearest to a query of this length; ties by number.
    pub fn nearest(&self, query: &[f32], k: usize) -> Vec<Neighbor> {
        self.nearest_first(query, &[], |vector| distance(query, vector)).take(k).collect()
    }

    /// The numbers and distances of all vectors, nearest first, ties by number; ordered as far as they are asked for.
    /// `distance` is the root of the sum of Huber's losses of differences from a query of this length, in double
    /// precision. It is asked for vectors that may be next: all are measured in single precision, which bounds it from below.
    /// Without a limit differences count by their squares.
    pub fn nearest_first<'t, D: Fn(&[f32]) -> f64 + 't>(
        &'t self,
        query: &[f32],
        limits: &[f32],
        distance: D,
    ) -> impl Iterator<Item = Neighbor> + use<'t, D> {
        let n = padded(self.dim);
        let [mut query, mut limits] = [query, limits].map(<[f32]>::to_vec);
        query.resize(n, 0.0);
        limits.resize(n, f32::INFINITY);
        // The bits of numbers that are not negative are in the order of the numbers.
        let at_least = move |sum: f32| least_loss(sum, n).sqrt().to_bits();
        let mut sums = vec![0.0; self.len()];
        let blocks = self.rows.par_chunks(BLOCK * n).zip(sums.par_chunks_mut(BLOCK)).with_min_len(TASK);
        let bounds = blocks.enumerate().map(|(block, (rows, sums))| {
            losses_into(&query, &limits, rows, sums);
            // What is not finite bounds nothing.
            let bound = |sum: &f32| if sum.is_finite() { *sum } else { 0.0 };
            let least = sums.iter().map(bound).fold(f32::INFINITY, f32::min);
            Reverse((at_least(least), Known::Block, block))
        });
        let mut left = BinaryHeap::from(bounds.collect::<Vec<_>>());
        std::iter::from_fn(move || {
            loop {
                let Reverse((bits, known, i)) = left.pop()?;
                match known {
                    Known::Block => {
                        let rows = (i * BLOCK..self.len()).take(BLOCK);
                        left.extend(rows.map(|row| Reverse((at_least(sums[row]), Known::Row, row))));
                    }
                    Known::Row => {
                        let bits = distance(self.vector(i)).to_bits();
                        left.push(Reverse((bits, Known::Distance, i)));
                    }
                    Known::Distance => return Some(Neighbor { index: i, distance: f64::from_bits(bits) }),
                }
            }
        })
    }
}

/// Euclidean distance, summed in double precision in the order of the numbers.
fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2)).sum::<f64>().sqrt()
}
