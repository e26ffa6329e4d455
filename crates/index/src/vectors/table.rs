//! The fused vectors of all shapes.

use rayon::prelude::*;
use retrieval::Neighbor;

use super::kernels::{padded, sq_distances_into};
use super::nearest::Nearest;

/// Rows in one parallel task.
const TASK: usize = 8192;

/// Rows measured together.
const CHUNK: usize = 256;

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
    pub(crate) fn push(&mut self, id: &str, vector: &[f32]) {
        self.dim = vector.len();
        self.ids.push(id.into());
        self.rows.extend_from_slice(vector);
        self.rows.resize(self.ids.len() * padded(self.dim), 0.0);
    }

    /// Number of shapes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.ids.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Length of a vector; 0 if there are none.
    #[must_use]
    pub fn dim(&self) -> usize {
        self.dim
    }

    /// The name of a shape.
    #[must_use]
    pub fn id(&self, i: usize) -> &str {
        &self.ids[i]
    }

    /// The vector of a shape.
    #[must_use]
    pub fn vector(&self, i: usize) -> &[f32] {
        &self.padded(i)[..self.dim]
    }

    pub(super) fn padded(&self, i: usize) -> &[f32] {
        let n = padded(self.dim);
        &self.rows[i * n..][..n]
    }

    /// The numbers and distances of the `k` vectors nearest to a query of this length; ties by number.
    #[must_use]
    pub fn nearest(&self, query: &[f32], k: usize) -> Vec<Neighbor> {
        if self.is_empty() {
            return Vec::new();
        }
        let n = padded(self.dim);
        let mut row = query.to_vec();
        row.resize(n, 0.0);
        let tasks = self.rows.par_chunks(TASK * n).enumerate().map(|(task, rows)| {
            let mut nearest = Nearest::new(k);
            let mut sqs = [0.0; CHUNK];
            for (i, rows) in rows.chunks(CHUNK * n).enumerate() {
                let sqs = &mut sqs[..rows.len() / n];
                sq_distances_into(&row, rows, sqs);
                nearest.offer_all((task * TASK + i * CHUNK) as u32, sqs);
            }
            nearest
        });
        let nearest = tasks.reduce(|| Nearest::new(k), Nearest::join);
        // Selected in single precision, sorted in double.
        let measured = |hit: super::nearest::Hit| {
            let index = hit.slot as usize;
            Neighbor { index, distance: distance(query, self.vector(index)) }
        };
        let mut found: Vec<Neighbor> = nearest.into_hits().map(measured).collect();
        found.sort_by(Neighbor::cmp);
        found.truncate(k);
        found
    }
}

/// Euclidean distance, summed in double precision in the order of the numbers.
fn distance(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(x, y)| (f64::from(*x) - f64::from(*y)).powi(2)).sum::<f64>().sqrt()
}
