//! A growing set of long vectors, processed in strips of rows.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use rayon::prelude::*;

use crate::Matrix;
use crate::decomposition::view;

/// Rows in a strip. A few vectors of this length fit into the first-level cache, and the fixed size fixes the order of
/// summation, so that results do not depend on the number of threads.
const ROWS: usize = 512;

/// Vectors of n rows, divided into strips of [`ROWS`] rows that are stored column by column: vectors can be appended in
/// place, and strips processed in parallel.
#[derive(Debug)]
pub(crate) struct Strips {
    n_rows: usize,
    n_columns: usize,
    strips: Vec<Vec<f64>>,
}

impl Strips {
    /// An empty set of vectors of `n_rows` rows.
    pub(crate) fn new(n_rows: usize) -> Self {
        Self { n_rows, n_columns: 0, strips: vec![Vec::new(); n_rows.div_ceil(ROWS)] }
    }

    /// Number of vectors.
    pub(crate) fn n_columns(&self) -> usize {
        self.n_columns
    }

    /// Appends the columns of a matrix.
    pub(crate) fn append(&mut self, columns: &Matrix) {
        for column in columns.as_slice().chunks_exact(self.n_rows) {
            self.strips.iter_mut().zip(column.chunks(ROWS)).for_each(|(strip, rows)| strip.extend(rows));
        }
        self.n_columns += columns.ncols();
    }

    /// The products `V' W` with the columns of a matrix.
    pub(crate) fn products(&self, w: &Matrix) -> Matrix {
        let (n, m) = (self.n_columns, w.ncols());
        // `W' V`, since only the first factor is copied where its rows are not contiguous.
        let parts: Vec<Matrix> = (0..self.strips.len())
            .into_par_iter()
            .map(|s| {
                let mut part = Matrix::zeros(m, n);
                let out = MatMut::from_column_major_slice_mut(part.as_mut_slice(), m, n);
                let rows = view(w).subrows(s * ROWS, self.height(s));
                matmul(out, Accum::Replace, rows.transpose(), self.strip(s), 1.0, Par::Seq);
                part
            })
            .collect();
        parts.iter().fold(Matrix::zeros(m, n), |sum, part| sum + part).transpose()
    }

    /// Adds `factor` times the combinations `V H` to the columns of a matrix.
    pub(crate) fn add_combinations(&self, w: &mut Matrix, h: &Matrix, factor: f64) {
        let m = w.ncols();
        let mut rest = MatMut::from_column_major_slice_mut(w.as_mut_slice(), self.n_rows, m);
        let mut outs = Vec::with_capacity(self.strips.len());
        for s in 0..self.strips.len() {
            let (out, below) = rest.split_at_row_mut(self.height(s));
            outs.push((s, out));
            rest = below;
        }
        outs.into_par_iter().for_each(|(s, out)| {
            matmul(out, Accum::Add, self.strip(s), view(h), factor, Par::Seq);
        });
    }

    /// Number of rows of a strip.
    fn height(&self, s: usize) -> usize {
        self.n_rows.min((s + 1) * ROWS) - s * ROWS
    }

    fn strip(&self, s: usize) -> MatRef<'_, f64> {
        MatRef::from_column_major_slice(&self.strips[s], self.height(s), self.n_columns)
    }
}
