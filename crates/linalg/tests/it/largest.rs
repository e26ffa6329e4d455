use base::{Budget, Exceeded};
use canonform_linalg::{LinalgError, Matrix, SymmetricOperator, largest_eigenpairs};

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

    fn apply(&self, columns: &Matrix) -> Matrix {
        let mut result = columns.clone();
        for mut column in result.column_iter_mut() {
            Self::reflect(column.as_mut_slice());
            column.iter_mut().zip(&self.spectrum).for_each(|(v, s)| *v *= s);
            Self::reflect(column.as_mut_slice());
        }
        result
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
        let x = found.vectors.columns(j, 1).into_owned();
        let residual = (operator.apply(&x) - x * *value).norm();
        assert!(residual < 1e-10 * scale, "{j}: residual {residual}");
    }
}

#[test]
fn finds_positive_pairs_behind_negative_ones_of_larger_magnitude() {
    let n = 1500;
    let spectrum = (0..n).map(|i| if i < 12 { -100.0 - i as f64 } else { 90.0 / (i - 11) as f64 }).collect();
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

/// An operator that cancels a budget at its first product.
#[derive(Debug)]
struct Cancelling(Reflected, Budget);

impl SymmetricOperator for Cancelling {
    fn order(&self) -> usize {
        self.0.order()
    }

    fn apply(&self, columns: &Matrix) -> Matrix {
        self.1.cancel();
        self.0.apply(columns)
    }
}

#[test]
fn an_iteration_ends_when_it_is_cancelled() {
    let (reflected, budget) = (Reflected { spectrum: vec![1.0; 600] }, Budget::unlimited());
    let found = largest_eigenpairs(&Cancelling(reflected, budget.clone()), 3, &budget);
    assert!(matches!(found, Err(LinalgError::Exceeded(Exceeded::Cancelled))), "{found:?}");
}

#[test]
fn zero_has_no_pairs() {
    let found = largest_eigenpairs(&Reflected { spectrum: vec![0.0; 400] }, 3, &()).unwrap();
    assert!(found.values.is_empty() && found.vectors.shape() == (400, 0), "{:?}", found.values);
}
