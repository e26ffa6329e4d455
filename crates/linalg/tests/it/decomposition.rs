use canonform_linalg::{
    LinalgError, Matrix, pseudo_inverse, symmetric_eigen, symmetric_eigenvalues, thin_qr,
};

fn wave(n: usize, m: usize) -> Matrix {
    Matrix::from_fn(n, m, |i, j| ((i * 7 + j * 3) as f64).sin() + if i == j { 2.0 } else { 0.0 })
}

#[test]
fn eigenpairs_are_sorted_and_orthonormal_with_small_residuals() {
    let a = wave(40, 40);
    let a = &a + a.transpose();
    let eigen = symmetric_eigen(&a).unwrap();
    assert!(eigen.values.windows(2).all(|w| w[0] >= w[1]));
    let residual = &a * &eigen.vectors - &eigen.vectors * Matrix::from_diagonal(&eigen.values.clone().into());
    assert!(residual.norm() < 1e-12 * a.norm());
    assert!((eigen.vectors.transpose() * &eigen.vectors - Matrix::identity(40, 40)).norm() < 1e-12);
    let alone = symmetric_eigenvalues(&a).unwrap();
    assert!(alone.iter().zip(&eigen.values).all(|(x, y)| (x - y).abs() < 1e-12 * a.norm()));
}

#[test]
fn nan_is_an_error() {
    let a = Matrix::from_element(3, 3, f64::NAN);
    assert_eq!(symmetric_eigen(&a), Err(LinalgError::NotConverged(3)));
    assert_eq!(symmetric_eigenvalues(&a), Err(LinalgError::NotConverged(3)));
}

#[test]
fn thin_qr_reproduces_a_rank_deficient_matrix() {
    let mut a = wave(50, 6);
    let twice = a.column(0) * 2.0;
    a.set_column(3, &twice);
    let (q, r) = thin_qr(&a);
    assert!((&q * &r - &a).norm() < 1e-13 * a.norm());
    assert!((q.transpose() * &q - Matrix::identity(6, 6)).norm() < 1e-13);
    assert!((0..6).all(|i| (0..i).all(|j| r[(i, j)] == 0.0)));
}

#[test]
fn the_pseudo_inverse_satisfies_the_penrose_conditions() {
    let mut a = wave(12, 5);
    let twice = a.column(0) * 2.0;
    a.set_column(3, &twice);
    for a in [a.clone(), a.transpose(), wave(4, 4), Matrix::zeros(3, 2)] {
        let x = pseudo_inverse(&a).unwrap();
        assert_eq!(x.shape(), (a.ncols(), a.nrows()));
        let gaps = [&a * &x * &a - &a, &x * &a * &x - &x];
        assert!(gaps.iter().all(|gap| gap.norm() < 1e-12 * (1.0 + a.norm())));
        for product in [&a * &x, &x * &a] {
            assert!((&product - product.transpose()).norm() < 1e-13);
        }
    }
    assert_eq!(pseudo_inverse(&Matrix::zeros(3, 0)).unwrap().shape(), (0, 3));
    let nan = Matrix::from_element(3, 2, f64::NAN);
    assert_eq!(pseudo_inverse(&nan), Err(LinalgError::NotConverged(3)));
}
