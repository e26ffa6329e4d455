//! Sparse symmetric matrices.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use rayon::prelude::*;

/// A symmetric n x n matrix of which the lower triangle is stored, column by column.
///
/// **Invariants.** The rows of a column ascend and start with the diagonal, which is always stored; no entry is stored
/// twice. The pattern contains all given entries, even zeros, so matrices with entries at the same places share an
/// [`EliminationOrder`](crate::EliminationOrder).
#[derive(Debug, Clone, PartialEq)]
pub struct SparseSymmetric {
    column_starts: Vec<usize>,
    rows: Vec<usize>,
    values: Vec<f64>,
}

impl SparseSymmetric {
    /// The matrix with the given `(row, column, value)` entries. Each also stands for its mirror image; entries at the
    /// same place are summed.
    ///
    /// # Panics
    /// If a row or column is not below `order`.
    pub fn from_entries(order: usize, entries: impl IntoIterator<Item = (usize, usize, f64)>) -> Self {
        let (mut diagonal, mut below) = (vec![0.0; order], Vec::new());
        for (i, j, value) in entries {
            assert!(i.max(j) < order, "entry ({i}, {j}) is outside of a matrix of order {order}");
            match i == j {
                true => diagonal[i] += value,
                false => below.push((i.min(j), i.max(j), value)),
            }
        }
        // A stable sort, so that sums are taken in the order of the entries.
        below.par_sort_by_key(|(column, row, _)| (*column, *row));
        let mut below = below.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)).peekable();
        let mut matrix = Self { column_starts: vec![0], rows: Vec::new(), values: Vec::new() };
        for (column, value) in diagonal.into_iter().enumerate() {
            matrix.rows.push(column);
            matrix.values.push(value);
            while let Some(run) = below.next_if(|run| run[0].0 == column) {
                matrix.rows.push(run[0].1);
                matrix.values.push(run.iter().map(|(.., value)| value).sum());
            }
            matrix.column_starts.push(matrix.rows.len());
        }
        matrix
    }

    /// The order n.
    pub fn order(&self) -> usize {
        self.column_starts.len() - 1
    }

    /// Number of stored entries, all in the lower triangle.
    pub fn n_stored(&self) -> usize {
        self.values.len()
    }

    /// The stored entries `(row, column, value)`, with `row >= column`.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let column = |j: usize| self.column_starts[j]..self.column_starts[j + 1];
        (0..self.order()).flat_map(move |j| column(j).map(move |at| (self.rows[at], j, self.values[at])))
    }

    /// The diagonal.
    pub fn diagonal(&self) -> Vec<f64> {
        (0..self.order()).map(|j| self.values[self.column_starts[j]]).collect()
    }

    /// Adds one number to each diagonal entry.
    ///
    /// # Panics
    /// If the number of numbers differs from the order.
    pub fn add_to_diagonal(&mut self, numbers: impl ExactSizeIterator<Item = f64>) {
        assert_eq!(numbers.len(), self.order(), "one number for each diagonal entry");
        for (start, number) in self.column_starts.iter().zip(numbers) {
            self.values[*start] += number;
        }
    }

    /// A view of the lower triangle for faer, without a copy.
    pub(crate) fn view(&self) -> SparseColMatRef<'_, usize, f64> {
        let n = self.order();
        let pattern = SymbolicSparseColMatRef::new_checked(n, n, &self.column_starts, None, &self.rows);
        SparseColMatRef::new(pattern, &self.values)
    }
}
