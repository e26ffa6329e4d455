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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Matrix;

    fn factorize(matrix: &SparseSymmetric) -> Result<SparseCholesky, LinalgError> {
        SparseCholesky::new(&EliminationOrder::new(matrix, &())?, matrix, &())
    }
    use crate::SymmetricOperator;

    /// The graph Laplacian of a `side` x `side` grid plus `mass` on the diagonal. Rows are numbered by a stride, so
    /// that their order is bad for elimination.
    fn grid(side: usize, mass: f64) -> SparseSymmetric {
        let n = side * side;
        let at = |i: usize, j: usize| (i * side + j) * 7919 % n;
        let pairs = (0..side).flat_map(|i| (0..side).map(move |j| (i, j))).flat_map(|(i, j)| {
            let right = (j + 1 < side).then(|| (at(i, j), at(i, j + 1)));
            let down = (i + 1 < side).then(|| (at(i, j), at(i + 1, j)));
            right.into_iter().chain(down)
        });
        let differences = pairs.flat_map(|(v, w)| [(v, v, 1.0), (w, w, 1.0), (v, w, -1.0)]);
        SparseSymmetric::from_entries(n, differences.chain((0..n).map(|v| (v, v, mass))))
    }

    fn right_hand_side(n: usize, seed: usize) -> Vec<f64> {
        (0..n).map(|i| (((i * 31 + seed * 17) % 101) as f64 - 50.0) / 7.0).collect()
    }

    fn residual(a: &SparseSymmetric, x: &[f64], b: &[f64]) -> f64 {
        let mut product = vec![0.0; b.len()];
        a.apply(x, &mut product);
        product.iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn solutions_have_small_residuals() {
        for (side, mass) in [(1, 1.0), (2, 0.1), (5, 1e-3), (40, 1.0), (60, 1e-6)] {
            let a = grid(side, mass);
            let factor = factorize(&a).unwrap();
            let b = right_hand_side(a.order(), 1);
            let mut x = b.clone();
            factor.solve(&mut x);
            let largest = x.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
            assert!(residual(&a, &x, &b) < 1e-14 * largest.max(50.0), "{side} {mass}");
        }
    }

    #[test]
    fn lanes_do_not_affect_each_other() {
        let a = grid(45, 0.01);
        let n = a.order();
        let factor = factorize(&a).unwrap();
        let columns = [0, 1, 2, 3].map(|seed| right_hand_side(n, seed));
        // One sparse right-hand side among dense ones.
        let sparse = |i: usize| if i == n / 3 { 1e200 } else { 0.0 };
        let mut four: Vec<[f64; 4]> =
            (0..n).map(|i| [columns[0][i], sparse(i), columns[2][i], columns[3][i]]).collect();
        factor.solve_ordered(&mut four);
        for lane in 0..4 {
            let mut one: Vec<[f64; 1]> =
                (0..n).map(|i| [if lane == 1 { sparse(i) } else { columns[lane][i] }]).collect();
            factor.solve_ordered(&mut one);
            assert!(one.iter().zip(&four).all(|([a], b)| a.to_bits() == b[lane].to_bits()), "lane {lane}");
        }
    }

    #[test]
    fn columns_do_not_affect_each_other() {
        let a = grid(31, 0.1);
        let factor = factorize(&a).unwrap();
        for count in [0, 1, 3, 9] {
            let b = Matrix::from_fn(a.order(), count, |i, j| right_hand_side(a.order(), j)[i]);
            let mut expected = b.clone();
            expected.column_iter_mut().for_each(|mut column| factor.solve(column.as_mut_slice()));
            let mut found = b.select_rows(factor.order().rows());
            factor.solve_ordered_columns(found.as_mut_slice());
            assert_eq!(found, expected.select_rows(factor.order().rows()));
        }
    }

    #[test]
    fn solutions_with_an_m_matrix_are_accurate_in_every_entry() {
        // The solution falls by orders of magnitude per step, but each entry is accurate because nothing is ever
        // subtracted.
        let a = grid(50, 30.0);
        let mut x = vec![0.0; a.order()];
        x[0] = 1e280;
        factorize(&a).unwrap().solve(&mut x);
        assert!(x.iter().all(|x| *x > 0.0));
        assert!(x.iter().fold(f64::MAX, |m, x| m.min(*x)) < 1e200);
        let mut terms = vec![[0.0; 2]; a.order()];
        let mut add = |row: usize, term: f64| {
            terms[row][0] += term;
            terms[row][1] += term.abs();
        };
        for (i, j, value) in a.entries() {
            add(i, value * x[j]);
            if i != j {
                add(j, value * x[i]);
            }
        }
        assert!(terms[1..].iter().all(|[sum, size]| sum.abs() < 1e-14 * size));
    }

    #[test]
    fn matrices_with_the_same_pattern_share_its_analysis() {
        let (light, heavy) = (grid(20, 1e-3), grid(20, 10.0));
        let order = EliminationOrder::new(&light, &()).unwrap();
        let mut rows = order.rows().to_vec();
        rows.sort_unstable();
        assert!(rows.iter().copied().eq(0..400));
        let b = right_hand_side(400, 5);
        let solve = |factor: SparseCholesky| {
            let mut x = b.clone();
            factor.solve(&mut x);
            x
        };
        let shared = solve(SparseCholesky::new(&order, &heavy, &()).unwrap());
        assert_eq!(shared, solve(factorize(&heavy).unwrap()));
    }

    #[test]
    fn an_empty_matrix_has_a_factor() {
        let factor = factorize(&SparseSymmetric::from_entries(0, [])).unwrap();
        factor.solve(&mut []);
        assert!(factor.order().rows().is_empty());
    }

    #[test]
    fn matrices_without_a_factor_give_an_error_with_the_reason() {
        let reason = |result: Result<SparseCholesky, LinalgError>| match result {
            Err(LinalgError::NotFactorized { reason, .. }) => reason.to_string(),
            other => panic!("{other:?}"),
        };
        assert!(reason(factorize(&grid(8, -0.5))).contains("not positive definite"));
        assert!(reason(factorize(&grid(8, f64::NAN))).contains("is NaN"));
        assert!(reason(factorize(&grid(8, f64::INFINITY))).contains("is inf"));
        let order = EliminationOrder::new(&grid(8, 1.0), &()).unwrap();
        assert!(reason(SparseCholesky::new(&order, &grid(9, 1.0), &())).contains("pattern"));
        let diagonal = SparseSymmetric::from_entries(64, []);
        assert!(reason(SparseCholesky::new(&order, &diagonal, &())).contains("pattern"));
    }
}
