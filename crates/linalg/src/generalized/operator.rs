//! The shift-and-invert operator, whose largest eigenvalues belong to the smallest of the pencil.

use base::Budget;

use crate::lanczos::weighted;
use crate::{EliminationOrder, LinalgError, Matrix, SparseCholesky, SparseSymmetric, SymmetricOperator};

/// `C = (W + s M)^-1 s M` with diagonal `M`, for vectors with rows in elimination order.
///
/// `C` is symmetric in the inner product `x' s M y`, and `W x = lambda M x` if and only if
/// `C x = s / (lambda + s) x`.
#[derive(Debug)]
pub(super) struct ShiftInverse {
    pub(super) factor: SparseCholesky,
    /// The diagonal of `s M`, in elimination order.
    masses: Vec<f64>,
    pub(super) shift: f64,
}

impl ShiftInverse {
    /// Factorizes `W + s M`. `s` is the median diagonal entry of `M^-1 W` divided by the order: on a surface about a
    /// third of the mean gap between eigenvalues, large enough for an accurate inverse and too small to cluster
    /// eigenvalues of `C`.
    ///
    /// An empty row without mass gets one on the diagonal.
    pub(super) fn new(
        stiffness: &SparseSymmetric,
        masses: &[f64],
        budget: &Budget,
    ) -> Result<Self, LinalgError> {
        let diagonal = stiffness.diagonal();
        let mut quotients: Vec<f64> =
            diagonal.iter().zip(masses).filter(|(_, m)| **m > 0.0).map(|(w, m)| w / m).collect();
        let middle = quotients.len() / 2;
        let median = match quotients.is_empty() {
            true => 0.0,
            false => *quotients.select_nth_unstable_by(middle, f64::total_cmp).1,
        };
        let shift = if median > 0.0 { median / stiffness.order() as f64 } else { 1.0 };
        let matrix = shifted(stiffness, masses, shift);
        let factor = SparseCholesky::new(&EliminationOrder::new(&matrix, budget)?, &matrix, budget)?;
        let masses = factor.order().rows().iter().map(|&row| shift * masses[row]).collect();
        Ok(Self { factor, masses, shift })
    }

    /// The eigenvalue `lambda` for an eigenvalue of `C`.
    pub(super) fn unshifted(&self, theta: f64) -> f64 {
        self.shift * (1.0 / theta - 1.0)
    }
}

impl SymmetricOperator for ShiftInverse {
    fn order(&self) -> usize {
        self.masses.len()
    }

    fn apply(&self, columns: &Matrix) -> Matrix {
        let mut result = weighted(self, columns);
        self.factor.solve_ordered_columns(result.as_mut_slice());
        result
    }

    fn masses(&self) -> Option<&[f64]> {
        Some(&self.masses)
    }
}

/// `W + s M`, with one on the diagonal of rows that would be empty.
pub(super) fn shifted(stiffness: &SparseSymmetric, masses: &[f64], shift: f64) -> SparseSymmetric {
    let mut matrix = stiffness.clone();
    matrix.add_to_diagonal(masses.iter().map(|m| shift * m));
    let missing: Vec<f64> = matrix.diagonal().iter().map(|d| if *d == 0.0 { 1.0 } else { 0.0 }).collect();
    matrix.add_to_diagonal(missing.into_iter());
    matrix
}
