//! Cholesky factors of sparse positive definite matrices.

use std::sync::Arc;

use base::Observer;
use faer::dyn_stack::{MemBuffer, MemStack};
use faer::linalg::cholesky::llt::factor::LltError;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::{Par, Side};
use rayon::prelude::*;

use crate::panels::Panels;
use crate::{LinalgError, NoFactor, SparseSymmetric};

/// The elimination order of a sparse matrix and the pattern of its Cholesky factor, which depend on the pattern of the
/// matrix but not on its values.
///
/// The order is approximate minimum degree. Cheap to clone, so matrices with the same pattern share it.
#[derive(Debug, Clone)]
pub struct EliminationOrder(pub(crate) Arc<Analysis>);

#[derive(Debug)]
pub(crate) struct Analysis {
    pub(crate) symbolic: SymbolicCholesky<usize>,
    pub(crate) panels: Panels,
    /// The row that each step eliminates.
    rows: Vec<usize>,
    /// Number of stored entries of the matrix.
    n_stored: usize,
}

impl EliminationOrder {
    /// Analyses the pattern of a matrix.
    ///
    /// # Errors
    /// [`LinalgError::NotFactorized`] if the factor does not fit into memory; [`LinalgError::Exceeded`] if it does not
    /// fit into the budget of the observer.
    pub fn new(matrix: &SparseSymmetric, observer: &dyn Observer) -> Result<Self, LinalgError> {
        let budget = observer.budget();
        budget.check()?;
        let n = matrix.order();
        // Panels even where single columns would factorize faster, because they make solving fast.
        let params = CholeskySymbolicParams {
            supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
            ..Default::default()
        };
        let pattern = matrix.view().symbolic();
        let symbolic = factorize_symbolic_cholesky(pattern, Side::Lower, SymmetricOrdering::Amd, params)
            .map_err(|_| LinalgError::NotFactorized { n, reason: NoFactor::OutOfMemory })?;
        budget.check()?;
        budget.check_memory(symbolic.len_val().saturating_mul(size_of::<f64>()))?;
        let rows = match symbolic.perm() {
            Some(perm) => perm.arrays().0.to_vec(),
            None => (0..n).collect(),
        };
        let panels = match symbolic.raw() {
            SymbolicCholeskyRaw::Supernodal(s) => {
                let (begin, end, values) = (s.supernode_begin(), s.supernode_end(), s.col_ptr_for_val());
                Panels::new(
                    (0..s.n_supernodes())
                        .map(|i| (begin[i]..end[i], s.supernode(i).pattern(), values[i]..values[i + 1])),
                )
            }
            // Occurs if there is nothing to eliminate. Columns start with their diagonal.
            SymbolicCholeskyRaw::Simplicial(s) => {
                let (starts, below) = (s.col_ptr(), s.row_idx());
                Panels::new((0..n).map(|j| {
                    let column = starts[j]..starts[j + 1];
                    (j..j + 1, &below[column.start + 1..column.end], column)
                }))
            }
        };
        Ok(Self(Arc::new(Analysis { symbolic, panels, rows, n_stored: matrix.n_stored() })))
    }

    /// The row that each elimination step eliminates: a permutation.
    pub fn rows(&self) -> &[usize] {
        &self.0.rows
    }
}

/// The Cholesky factor `A = L L'` of a sparse positive definite matrix.
///
/// * Factorized sequentially, so the result does not depend on the number of threads.
/// * `solve` may be called from any number of threads.
///
/// Cost on a surface of n vertices: `O(n^1.5)` to factorize, `O(n log n)` memory and time to solve.
///
/// ```
/// use canonform_linalg::{EliminationOrder, SparseCholesky, SparseSymmetric};
///
/// let a = SparseSymmetric::from_entries(2, [(0, 0, 2.0), (1, 1, 2.0), (0, 1, 1.0)]);
/// let mut x = [3.0, 3.0];
/// SparseCholesky::new(&EliminationOrder::new(&a, &())?, &a, &())?.solve(&mut x);
/// assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-12));
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
#[derive(Debug)]
pub struct SparseCholesky {
    order: EliminationOrder,
    values: Vec<f64>,
}

impl SparseCholesky {
    /// Factorizes a matrix whose pattern has been analyzed before, possibly on another matrix. The factorization itself
    /// cannot be interrupted: the budget of the observer is checked before and after it.
    ///
    /// # Errors
    /// [`LinalgError::NotFactorized`] if an entry is not finite, the matrix is numerically not positive definite, or the
    /// pattern has another number of entries; [`LinalgError::Exceeded`].
    pub fn new(
        order: &EliminationOrder,
        matrix: &SparseSymmetric,
        observer: &dyn Observer,
    ) -> Result<Self, LinalgError> {
        let budget = observer.budget();
        budget.check()?;
        let n = matrix.order();
        let failed = |reason| LinalgError::NotFactorized { n, reason };
        if (n, matrix.n_stored()) != (order.0.rows.len(), order.0.n_stored) {
            return Err(failed(NoFactor::OtherPattern));
        }
        if let Some((row, column, value)) = matrix.entries().find(|(_, _, value)| !value.is_finite()) {
            return Err(failed(NoFactor::NotFinite { row, column, value }));
        }
        let symbolic = &order.0.symbolic;
        let mut values = budget.vector(symbolic.len_val())?;
        let scratch = symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Default::default());
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| failed(NoFactor::OutOfMemory))?;
        symbolic
            .factorize_numeric_llt(
                &mut values,
                matrix.view(),
                Side::Lower,
                Default::default(),
                Par::Seq,
                MemStack::new(&mut memory),
                Default::default(),
            )
            .map_err(|LltError::NonPositivePivot { index }| {
                failed(NoFactor::NotPositiveDefinite { column: index })
            })?;
        budget.check()?;
        Ok(Self { order: order.clone(), values })
    }

    /// The elimination order.
    pub fn order(&self) -> &EliminationOrder {
        &self.order
    }

    /// Overwrites `x` with the solution `y` of `A y = x`.
    ///
    /// # Panics
    /// If the length of `x` differs from the order of the matrix.
    pub fn solve(&self, x: &mut [f64]) {
        let rows = self.order.rows();
        assert_eq!(x.len(), rows.len(), "one right-hand side entry for each row");
        let mut ordered: Vec<[f64; 1]> = rows.iter().map(|&row| [x[row]]).collect();
        self.solve_ordered(&mut ordered);
        for ([value], &row) in ordered.iter().zip(rows) {
            x[row] = *value;
        }
    }

    /// Solves for columns stored one after the other, with rows in elimination order.
    pub(crate) fn solve_ordered_columns(&self, columns: &mut [f64]) {
        let n = self.order.rows().len();
        if n == 0 {
            return;
        }
        // Few enough per group to keep all threads busy; more than four together do not pay.
        let lanes = (columns.len() / n).div_ceil(rayon::current_num_threads()).clamp(1, 4);
        columns.par_chunks_mut(lanes * n).for_each(|part| match part.len() / n {
            1 => self.solve_lanes::<1>(part),
            2 => self.solve_lanes::<2>(part),
            3 => self.solve_lanes::<3>(part),
            _ => self.solve_lanes::<4>(part),
        });
    }

    fn solve_lanes<const K: usize>(&self, columns: &mut [f64]) {
        let n = self.order.rows().len();
        let mut lanes: Vec<[f64; K]> = (0..n).map(|i| std::array::from_fn(|k| columns[k * n + i])).collect();
        self.solve_ordered(&mut lanes);
        for (i, lane) in lanes.iter().enumerate() {
            lane.iter().enumerate().for_each(|(k, value)| columns[k * n + i] = *value);
        }
    }

    /// Solves for `K` right-hand sides at once, with rows in [elimination order](EliminationOrder::rows). Lanes do not
    /// affect each other.
    ///
    /// Rows before the first nonzero entry cost nothing in the forward pass.
    ///
    /// # Panics
    /// If the length of `x` differs from the order of the matrix.
    pub fn solve_ordered<const K: usize>(&self, x: &mut [[f64; K]]) {
        assert_eq!(x.len(), self.order.rows().len(), "one right-hand side entry for each row");
        self.order.0.panels.solve(&self.values, x);
    }
}
