//! The number of negative eigenvalues of a sparse symmetric matrix.

use base::Budget;
use faer::Par;
use faer::dyn_stack::{MemBuffer, MemStack};

use crate::{EliminationOrder, LinalgError, NoFactor, SparseSymmetric};

/// The number of negative eigenvalues of a matrix whose pattern has been analyzed. By Sylvester's law of inertia it
/// equals that of the block diagonal `B` in `A = L B L'` (Bunch and Kaufman, pivoting inside panels).
///
/// For `A = W - sigma M` with `M` positive semidefinite, it is the number of eigenvalues of `W x = lambda M x` below
/// `sigma`.
///
/// Returns `None` if a pivot is numerically zero: then the matrix, or a panel of it, has an eigenvalue at zero.
///
/// # Errors
/// [`LinalgError::Exceeded`]; [`LinalgError::NotFactorized`] if memory runs out.
pub(super) fn n_negative(
    order: &EliminationOrder,
    matrix: &SparseSymmetric,
    budget: &Budget,
) -> Result<Option<usize>, LinalgError> {
    budget.check()?;
    let n = matrix.order();
    let symbolic = &order.0.symbolic;
    let mut values = budget.vector(symbolic.len_val())?;
    let mut off_diagonal = vec![0.0; n];
    let [mut forward, mut inverse] = [vec![0; n], vec![0; n]];
    let scratch = symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Default::default());
    let mut memory = MemBuffer::try_new(scratch)
        .map_err(|_| LinalgError::NotFactorized { n, reason: NoFactor::OutOfMemory })?;
    symbolic.factorize_numeric_intranode_lblt(
        &mut values,
        &mut off_diagonal,
        &mut forward,
        &mut inverse,
        matrix.view(),
        faer::Side::Lower,
        Par::Seq,
        MemStack::new(&mut memory),
        Default::default(),
    );
    let diagonal = order.0.panels.diagonal(&values);
    let mut negative = 0;
    let mut i = 0;
    while i < n {
        let (pivot, count, width) = match off_diagonal[i] {
            0.0 => (diagonal[i], usize::from(diagonal[i] < 0.0), 1),
            off => {
                let [a, b] = [diagonal[i], diagonal[i + 1]];
                let determinant = a * b - off * off;
                (determinant, if determinant < 0.0 { 1 } else { 2 * usize::from(a < 0.0) }, 2)
            }
        };
        if pivot == 0.0 || !pivot.is_finite() {
            return Ok(None);
        }
        negative += count;
        i += width;
    }
    Ok(Some(negative))
}
