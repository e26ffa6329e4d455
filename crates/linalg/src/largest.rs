//! A few eigenpairs of a large symmetric operator.

use base::Observer;

use crate::lanczos::Lanczos;
use crate::{LinalgError, SymmetricEigen, SymmetricOperator};

/// The residual up to which a pair counts as found, relative to the norm of the operator.
const TOLERANCE: f64 = 1e-11;

/// The `k` algebraically largest eigenpairs of a symmetric operator (fewer if its order is less than `k`, or if only zeros would
/// follow), to a residual of `1e-11` of its norm.
///
/// A block Lanczos process with full orthogonalisation, from a fixed start. It finds both ends of the spectrum: with many
/// eigenvalues of large magnitude below the wanted ones it takes up to `n` products.
///
/// Cost: `m` products and `O(n m^2)` operations for m a small multiple of `k`; `O(n m)` memory.
///
/// The budget of the observer is checked before every block of products.
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
    let mut process = Lanczos::new(operator);
    let mut next = 2 * k + 16;
    loop {
        budget.check_memory(next.min(n).saturating_mul(n).saturating_mul(size_of::<f64>()))?;
        while process.dim() < next && !process.is_exhausted() {
            budget.check()?;
            process.step();
        }
        let ritz = process.ritz()?;
        let values = &ritz.eigen.values;
        let norm = values.first().zip(values.last()).map_or(0.0, |(first, last)| first.abs().max(last.abs()));
        // What the process does not reach is mapped to zero.
        let is_whole = process.dim() == n;
        let n_found = values.iter().take(k).take_while(|value| is_whole || **value > 0.0).count();
        let is_found = |j: usize| ritz.absolute_residual(j) <= TOLERANCE * norm;
        if process.is_exhausted() || (n_found == k && (0..k).all(is_found)) {
            let vectors = process.vectors(&ritz, n_found);
            return Ok(SymmetricEigen { values: values[..n_found].to_vec(), vectors });
        }
        next += next / 4;
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use base::{Budget, Exceeded};

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
    fn finds_negative_pairs_if_few_are_positive() {
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
    fn zero_has_no_pairs() {
        let found = largest_eigenpairs(&Reflected { spectrum: vec![0.0; 400] }, 3, &()).unwrap();
        assert!(found.values.is_empty() && found.vectors.shape() == (400, 0), "{:?}", found.values);
    }
}
