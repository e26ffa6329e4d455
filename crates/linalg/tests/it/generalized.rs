use std::f64::consts::PI;

use canonform_linalg::{LinalgError, Matrix, SparseSymmetric, SymmetricEigen, smallest_eigenpairs};

use crate::sparse::product;

/// The stiffness matrix of `n` points joined by springs of the given weights.
fn springs(n: usize, pairs: impl IntoIterator<Item = (usize, usize, f64)>) -> SparseSymmetric {
    let entries = pairs.into_iter().flat_map(|(i, j, w)| [(i, i, w), (j, j, w), (i, j, -w)]);
    SparseSymmetric::from_entries(n, entries)
}

fn smallest(w: &SparseSymmetric, masses: &[f64], m: usize) -> Result<SymmetricEigen, LinalgError> {
    smallest_eigenpairs(w, masses, m, SymmetricEigen::ACCURATE, &())
}

/// A `k` x `l` grid of unit springs, periodic in both directions.
fn torus(k: usize, l: usize) -> SparseSymmetric {
    let at = |i: usize, j: usize| (i % k) * l + j % l;
    springs(
        k * l,
        (0..k)
            .flat_map(|i| (0..l).map(move |j| (i, j)))
            .flat_map(|(i, j)| [(at(i, j), at(i + 1, j), 1.0), (at(i, j), at(i, j + 1), 1.0)]),
    )
}

/// The largest `|W x - lambda M x|` relative to the largest eigenvalue found, and the largest entry of `X' M X - I`.
fn faults(w: &SparseSymmetric, masses: &[f64], found: &SymmetricEigen) -> [f64; 2] {
    let n = w.order();
    let scale = found.values.last().copied().unwrap_or(1.0);
    let mut weighted = found.vectors.clone();
    let mut worst = 0.0f64;
    for (x, value) in found.vectors.column_iter().zip(&found.values) {
        let image = product(w, x.as_slice());
        let residual = (0..n).map(|i| image[i] - value * masses[i] * x[i]).map(|r| r * r).sum::<f64>().sqrt();
        worst = worst.max(residual / scale);
    }
    for mut column in weighted.column_iter_mut() {
        column.iter_mut().zip(masses).for_each(|(x, m)| *x *= m);
    }
    let gram = found.vectors.transpose() * weighted;
    [worst, (&gram - Matrix::identity(gram.nrows(), gram.ncols())).amax()]
}

#[test]
fn eigenvalues_of_closed_form_come_with_their_multiplicities() {
    // `4 sin^2(pi a / k) + 4 sin^2(pi b / l)`. The square torus has multiplicities four and eight. With 240 of 600 pairs, the
    // eigenvalues are counted below a number near the diagonal, which needs pivots of two rows.
    let sine = |a: usize, k: usize| 4.0 * (PI * a as f64 / k as f64).sin().powi(2);
    let tori = [(40, 40, 90), (37, 23, 60), (9, 8, 72), (100, 3, 13), (30, 20, 240)].map(|(k, l, m)| {
        let values = (0..k).flat_map(|a| (0..l).map(move |b| sine(a, k) + sine(b, l)));
        (torus(k, l), values.collect::<Vec<_>>(), m)
    });
    // Thirty rings of 24 points: zero is 30-fold, the next eigenvalue 60-fold.
    let rings = springs(720, (0..720).map(|v| (v, v / 24 * 24 + (v + 1) % 24, 1.0)));
    let rings = (rings, (0..720).map(|j| sine(j / 30, 24)).collect(), 70);
    for (w, mut expected, m) in tori.into_iter().chain([rings]) {
        let (n, masses) = (w.order(), vec![1.0; w.order()]);
        // Large eigenvalues amplify the residuals of inverses.
        let tolerance = SymmetricEigen::ACCURATE * if m > 100 { 0.1 } else { 1.0 };
        let found = smallest_eigenpairs(&w, &masses, m, tolerance, &()).unwrap();
        assert_eq!(found.values.len(), m);
        expected.sort_by(f64::total_cmp);
        for (i, (a, b)) in found.values.iter().zip(&expected).enumerate() {
            assert!((a - b).abs() < 1e-9 * (b + 1e-3), "order {n}, {i}: {a} against {b}");
        }
        let [residual, orthogonality] = faults(&w, &masses, &found);
        assert!(residual < 1e-9 && orthogonality < 1e-12, "{residual} {orthogonality}");
    }
}

#[test]
fn eigenvalues_scale_inversely_with_masses() {
    let w = torus(30, 20);
    let masses: Vec<f64> = (0..600).map(|i| 1.0 + 0.9 * (i as f64).sin()).collect();
    let found = smallest(&w, &masses, 40).unwrap();
    let [residual, orthogonality] = faults(&w, &masses, &found);
    assert!(residual < 1e-9 && orthogonality < 1e-12, "{residual} {orthogonality}");
    for scale in [1e-12, 1e12] {
        let scaled: Vec<f64> = masses.iter().map(|m| scale * m).collect();
        let other = smallest(&w, &scaled, 40).unwrap();
        for j in 1..40 {
            let ratio = other.values[j] * scale / found.values[j];
            assert!((ratio - 1.0).abs() < 1e-9, "{j} {scale}: {ratio}");
        }
    }
}

#[test]
fn rows_without_mass_follow_the_others_and_isolated_ones_are_zero() {
    // A path with mass on every second point equals one of half as many points with springs half as stiff.
    let n = 81;
    let path = springs(n + 1, (1..n).map(|i| (i - 1, i, 1.0)));
    let masses: Vec<f64> = (0..=n).map(|i| if i < n && i % 2 == 0 { 1.0 } else { 0.0 }).collect();
    let found = smallest(&path, &masses, 100).unwrap();
    assert_eq!(found.values.len(), 41, "one pair per mass");
    for (j, value) in found.values.iter().enumerate() {
        let expected = 2.0 * (PI * j as f64 / 82.0).sin().powi(2);
        assert!((value - expected).abs() < 1e-10, "{j}: {value} against {expected}");
    }
    // Vectors of the largest eigenvalues are less accurate.
    for x in found.vectors.column_iter().take(20) {
        let fault = |i: usize| (x[i] - 0.5 * (x[i - 1] + x[i + 1])).abs();
        let worst = (1..n - 1).step_by(2).map(fault).fold(0.0, f64::max);
        assert!(worst < 1e-8, "{worst}");
        assert_eq!(x[n], 0.0);
    }
}

#[test]
fn results_do_not_depend_on_threads() {
    let w = torus(45, 31);
    let masses: Vec<f64> = (0..45 * 31).map(|i| 1.0 + 0.3 * (i as f64).cos()).collect();
    let on = |threads| {
        let found = || smallest(&w, &masses, 30).unwrap();
        testkit::on_threads(threads, found)
    };
    let one = on(1);
    // Bit for bit, at any alignment of the vectors in memory.
    assert_eq!(one, on(1));
    let padding = vec![0u8; 24];
    assert_eq!(one, on(2));
    drop(padding);
    assert_eq!(one, on(4));
}

#[test]
fn small_and_empty_matrices_have_all_their_pairs() {
    let one = smallest(&SparseSymmetric::from_entries(1, [(0, 0, 6.0)]), &[2.0], 5).unwrap();
    assert!(one.values.len() == 1 && (one.values[0] - 3.0).abs() < 1e-14);
    assert!((one.vectors[(0, 0)] - 0.5f64.sqrt()).abs() < 1e-15);
    let none = smallest(&SparseSymmetric::from_entries(0, []), &[], 5).unwrap();
    assert_eq!((none.values.len(), none.vectors.shape()), (0, (0, 0)));
    let none_wanted =
        smallest_eigenpairs(&torus(4, 4), &[1.0; 16], 0, SymmetricEigen::ACCURATE, &()).unwrap();
    assert_eq!((none_wanted.values.len(), none_wanted.vectors.shape()), (0, (16, 0)));
    let massless = smallest_eigenpairs(&torus(4, 4), &[0.0; 16], 3, SymmetricEigen::ACCURATE, &());
    assert_eq!(massless.map(|found| found.values.len()), Ok(0));
}
