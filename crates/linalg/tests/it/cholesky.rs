use canonform_linalg::{EliminationOrder, LinalgError, SparseCholesky, SparseSymmetric};

use crate::sparse::product;

fn factorize(matrix: &SparseSymmetric) -> Result<SparseCholesky, LinalgError> {
    SparseCholesky::new(&EliminationOrder::new(matrix, &())?, matrix, &())
}

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

fn right_hand_side(n: usize) -> Vec<f64> {
    (0..n).map(|i| ((i * 31 % 101) as f64 - 50.0) / 7.0).collect()
}

fn residual(a: &SparseSymmetric, x: &[f64], b: &[f64]) -> f64 {
    product(a, x).iter().zip(b).map(|(p, b)| (p - b).abs()).fold(0.0, f64::max)
}

#[test]
fn solutions_have_small_residuals() {
    for (side, mass) in [(1, 1.0), (2, 0.1), (5, 1e-3), (40, 1.0), (60, 1e-6)] {
        // Matrices with the same pattern share its analysis.
        let order = EliminationOrder::new(&grid(side, 1.0), &()).unwrap();
        let a = grid(side, mass);
        let factor = SparseCholesky::new(&order, &a, &()).unwrap();
        let b = right_hand_side(a.order());
        let mut x = b.clone();
        factor.solve(&mut x);
        let largest = x.iter().fold(0.0, |m, x| f64::max(m, x.abs()));
        assert!(residual(&a, &x, &b) < 1e-14 * largest.max(50.0), "{side} {mass}");
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
