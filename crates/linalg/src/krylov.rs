//! A few eigenpairs of a large symmetric operator.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::atomic::{AtomicUsize, Ordering};

use base::{Budget, Exceeded, Observer};
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::matrix_free::LinOp;
use faer::matrix_free::eigen::{
    PartialEigenParams, partial_self_adjoint_eigen, partial_self_adjoint_eigen_scratch,
};
use faer::{ColRef, Mat, MatMut, MatRef, Par};

use crate::decomposition::from_faer;
use crate::{LinalgError, Matrix, SymmetricEigen, symmetric_eigen};

/// A symmetric n x n matrix, given by its products with vectors.
pub trait SymmetricOperator: Sync + std::fmt::Debug {
    /// The order n of the matrix.
    fn order(&self) -> usize;

    /// Writes the product of the matrix with `x` into `y`; both have n entries.
    fn apply(&self, x: &[f64], y: &mut [f64]);
}

/// Up to this order the full decomposition is faster than the iteration.
const DENSE_ORDER: usize = 256;

/// The `k` algebraically largest eigenpairs of a symmetric operator (all if the order is less than `k`), to a residual
/// of `1e-11` of its norm.
///
/// A Krylov iteration with thick restarts finds the pairs of largest *magnitude*. It computes more of them until `k` are
/// positive, and falls back to the full decomposition if there are not enough (a nearly negative definite operator).
///
/// Cost: `O(m)` products and `O(n m^2)` operations for m a small multiple of `k`; `O(n m)` memory.
///
/// The budget of the observer is checked before every product.
///
/// # Errors
/// [`LinalgError::NotConverged`], [`LinalgError::Exceeded`].
///
/// ```
/// use canonform_linalg::{SparseSymmetric, largest_eigenpairs};
///
/// let diagonal = SparseSymmetric::from_entries(300, (0..300).map(|i| (i, i, 1.0 / (1.0 + i as f64))));
/// let eigen = largest_eigenpairs(&diagonal, 2, &())?;
/// assert!((eigen.values[0] - 1.0).abs() < 1e-9 && (eigen.values[1] - 0.5).abs() < 1e-9);
/// # Ok::<(), canonform_linalg::LinalgError>(())
/// ```
pub fn largest_eigenpairs(
    operator: &dyn SymmetricOperator,
    k: usize,
    observer: &dyn Observer,
) -> Result<SymmetricEigen, LinalgError> {
    let budget = &observer.budget();
    let n = operator.order();
    let k = k.min(n);
    let mut wanted = k + 4;
    while n > DENSE_ORDER && 8 * wanted < n {
        let found = largest_magnitude(operator, wanted, budget)?;
        let mut positive: Vec<usize> = (0..found.values.len()).filter(|&i| found.values[i] > 0.0).collect();
        if positive.len() >= k {
            positive.sort_by(|&i, &j| found.values[j].total_cmp(&found.values[i]));
            positive.truncate(k);
            return Ok(found.select(&positive));
        }
        wanted *= 3;
    }
    let mut dense = Matrix::from_vec(n, n, budget.vector(n.saturating_mul(n))?);
    let mut unit = vec![0.0; n];
    let mut column = vec![0.0; n];
    for j in 0..n {
        budget.check()?;
        unit[j] = 1.0;
        operator.apply(&unit, &mut column);
        unit[j] = 0.0;
        dense.column_mut(j).copy_from_slice(&column);
    }
    let eigen = symmetric_eigen(&dense)?;
    Ok(eigen.select(&(0..k.min(n)).collect::<Vec<_>>()))
}

/// Up to `m` converged eigenpairs of largest magnitude; requires `8 m < n`.
fn largest_magnitude(
    operator: &dyn SymmetricOperator,
    m: usize,
    budget: &Budget,
) -> Result<SymmetricEigen, Exceeded> {
    let n = operator.order();
    let wrapped = Wrapped { operator, budget, n_zeros: AtomicUsize::new(0) };
    // A fixed start vector without symmetry, so that no eigenvector of a symmetric shape is orthogonal to it.
    let start: Vec<f64> = (0..n).map(uneven).collect();
    let params =
        PartialEigenParams { min_dim: 2 * m, max_dim: (4 * m).max(64).min(n - 1), ..Default::default() };
    let tolerance = 1e-11 * operator_scale(operator, &start);
    let mut vectors = Mat::<f64>::zeros(n, m);
    let mut values = vec![0.0; m];
    let mut memory = MemBuffer::new(partial_self_adjoint_eigen_scratch(&wrapped, m, Par::Seq, params));
    let iteration = AssertUnwindSafe(|| {
        partial_self_adjoint_eigen(
            vectors.as_mut(),
            &mut values,
            &wrapped,
            ColRef::from_slice(&start),
            tolerance,
            Par::Seq,
            MemStack::new(&mut memory),
            params,
        )
    });
    let info = catch_unwind(iteration).map_err(|payload| match payload.downcast() {
        Ok(exceeded) => *exceeded,
        Err(panic) => resume_unwind(panic),
    })?;
    values.truncate(info.n_converged_eigen);
    Ok(SymmetricEigen { vectors: from_faer(vectors.as_ref().subcols(0, values.len())), values })
}

/// The size of the product with a vector of the kernel, far below any tolerance.
const KERNEL: f64 = 1e-100;

/// Entries of a vector without symmetry, from 1 to 1.5.
fn uneven(i: usize) -> f64 {
    1.0 + 0.5 * (i as f64 * 0.754_877_666).fract()
}

/// A lower bound of the operator's norm by a few power iterations, for relative tolerances.
fn operator_scale(operator: &dyn SymmetricOperator, start: &[f64]) -> f64 {
    let norm = |x: &[f64]| x.iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut x = start.to_vec();
    let mut y = vec![0.0; x.len()];
    let mut scale = 0.0;
    for _ in 0..4 {
        let length = norm(&x);
        if length == 0.0 {
            break;
        }
        x.iter_mut().for_each(|v| *v /= length);
        operator.apply(&x, &mut y);
        scale = f64::max(scale, norm(&y));
        std::mem::swap(&mut x, &mut y);
    }
    scale.max(f64::MIN_POSITIVE)
}

/// Adapts a [`SymmetricOperator`] to faer. When the budget is exceeded, it leaves the iteration by unwinding: that has
/// no other way to end early.
#[derive(Debug)]
struct Wrapped<'a> {
    operator: &'a dyn SymmetricOperator,
    budget: &'a Budget,
    /// How many products were zero.
    n_zeros: AtomicUsize,
}

impl LinOp<f64> for Wrapped<'_> {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.operator.order()
    }

    fn ncols(&self) -> usize {
        self.operator.order()
    }

    fn apply(&self, mut out: MatMut<'_, f64>, rhs: MatRef<'_, f64>, _: Par, _: &mut MemStack) {
        if let Err(exceeded) = self.budget.check() {
            resume_unwind(Box::new(exceeded));
        }
        let n = self.operator.order();
        let mut y = vec![0.0; n];
        for j in 0..rhs.ncols() {
            let x: Vec<f64> = (0..n).map(|i| rhs[(i, j)]).collect();
            self.operator.apply(&x, &mut y);
            if y.iter().all(|value| *value == 0.0) {
                // The iteration would never end: it waits until the product is orthogonal to what it has.
                let first = n * self.n_zeros.fetch_add(1, Ordering::Relaxed);
                y.iter_mut().zip(first..).for_each(|(value, i)| *value = KERNEL * uneven(i));
            }
            for (i, value) in y.iter().enumerate() {
                out[(i, j)] = *value;
            }
        }
    }

    fn conj_apply(&self, out: MatMut<'_, f64>, rhs: MatRef<'_, f64>, par: Par, stack: &mut MemStack) {
        self.apply(out, rhs, par, stack);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A diagonal matrix conjugated by a Householder reflection: known spectrum, dense eigenvectors.
    #[derive(Debug)]
    struct Reflected {
        spectrum: Vec<f64>,
    }

    impl Reflected {
        fn reflect(x: &mut [f64]) {
            let n = x.len() as f64;
            let mean = 2.0 * x.iter().sum::<f64>() / n;
            x.iter_mut().for_each(|v| *v -= mean);
        }
    }

    impl SymmetricOperator for Reflected {
        fn order(&self) -> usize {
            self.spectrum.len()
        }

        fn apply(&self, x: &[f64], y: &mut [f64]) {
            y.copy_from_slice(x);
            Self::reflect(y);
            y.iter_mut().zip(&self.spectrum).for_each(|(v, s)| *v *= s);
            Self::reflect(y);
        }
    }

    fn check(spectrum: Vec<f64>, k: usize) {
        let mut sorted = spectrum.clone();
        sorted.sort_by(|a, b| b.total_cmp(a));
        let operator = Reflected { spectrum };
        let n = operator.order();
        let found = largest_eigenpairs(&operator, k, &()).unwrap();
        let scale = sorted[0].abs().max(sorted[n - 1].abs());
        assert_eq!(found.values.len(), k.min(n));
        for (j, value) in found.values.iter().enumerate() {
            assert!((value - sorted[j]).abs() < 1e-10 * scale, "{j}: {value} against {}", sorted[j]);
            let x = found.vectors.column(j).as_slice().to_vec();
            let mut y = vec![0.0; n];
            operator.apply(&x, &mut y);
            let residual: f64 = y.iter().zip(&x).map(|(y, x)| (y - value * x).powi(2)).sum::<f64>().sqrt();
            assert!(residual < 1e-10 * scale, "{j}: residual {residual}");
        }
    }

    #[test]
    fn finds_positive_pairs_behind_negative_ones_of_larger_magnitude() {
        let n = 1500;
        let spectrum =
            (0..n).map(|i| if i < 12 { -100.0 - i as f64 } else { 90.0 / (i - 11) as f64 }).collect();
        check(spectrum, 3);
    }

    #[test]
    fn falls_back_to_the_full_decomposition_if_few_are_positive() {
        check((0..300).map(|i| if i == 5 { 1.0 } else { -1.0 - i as f64 }).collect(), 2);
    }

    #[test]
    fn small_operators_have_fewer_pairs_than_requested() {
        check(vec![3.0, -7.0, 2.0], 5);
    }

    /// An operator that cancels the budget at one of its products.
    #[derive(Debug)]
    struct Cancelling {
        reflected: Reflected,
        budget: Budget,
        left: AtomicUsize,
    }

    impl SymmetricOperator for Cancelling {
        fn order(&self) -> usize {
            self.reflected.order()
        }

        fn apply(&self, x: &[f64], y: &mut [f64]) {
            if self.left.fetch_sub(1, Ordering::Relaxed) == 1 {
                self.budget.cancel();
            }
            self.reflected.apply(x, y);
        }
    }

    #[test]
    fn an_iteration_ends_wherever_it_is_cancelled() {
        for at in 1..40 {
            let budget = Budget::unlimited();
            let reflected = Reflected { spectrum: (0..600).map(|i| 1.0 / (1.0 + f64::from(i))).collect() };
            let operator = Cancelling { reflected, budget: budget.clone(), left: at.into() };
            let found = largest_eigenpairs(&operator, 3, &budget);
            assert!(matches!(found, Err(LinalgError::Exceeded(Exceeded::Cancelled))), "{at}: {found:?}");
        }
    }

    #[test]
    fn the_pairs_of_zero_are_zero() {
        let found = largest_eigenpairs(&Reflected { spectrum: vec![0.0; 400] }, 3, &()).unwrap();
        assert!(found.values.iter().all(|value| value.abs() < 1e-90), "{:?}", found.values);
    }
}
