use std::f64::consts::PI;

use canonform_nmds::*;
use linalg::{
    LandmarkDistances, Matrix, SparseSymmetric, SymmetricEigen, smallest_eigenpairs, symmetric_eigen,
};

use crate::support::pairwise;

/// The `m` smallest eigenpairs of a ring of `p` points with unit springs.
struct Ring {
    values: Vec<f64>,
    vectors: Matrix,
    masses: Vec<f64>,
}

impl Ring {
    fn new(p: usize, m: usize) -> Self {
        let spring = |i: usize| [(i, i, 2.0), (i, (i + 1) % p, -1.0)];
        let stiffness = SparseSymmetric::from_entries(p, (0..p).flat_map(spring));
        let masses = vec![1.0; p];
        let SymmetricEigen { values, vectors } =
            smallest_eigenpairs(&stiffness, &masses, m, SymmetricEigen::ACCURATE, &()).unwrap();
        Self { values, vectors, masses }
    }

    fn basis(&self) -> SpectralBasis<'_> {
        SpectralBasis { values: &self.values, vectors: &self.vectors, masses: &self.masses }
    }
}

/// Distances from every `step`-th of `p` points on a ring.
fn columns(p: usize, step: usize, distance: impl Fn(usize, usize) -> f64) -> LandmarkDistances {
    let samples: Vec<usize> = (0..p).step_by(step).collect();
    let columns = Matrix::from_fn(p, samples.len(), |i, j| distance(i, samples[j]));
    LandmarkDistances::new(samples, columns).unwrap()
}

fn arc(p: usize) -> impl Fn(usize, usize) -> f64 {
    move |i, j| i.abs_diff(j).min(p - i.abs_diff(j)) as f64
}

/// Chords of a circle: their squares, 2 - 2 cos(s - t), are of frequency one.
fn chord(p: usize) -> impl Fn(usize, usize) -> f64 {
    move |i, j| 2.0 * (PI * i.abs_diff(j) as f64 / p as f64).sin()
}

/// The embedding in the plane of arcs of a ring of 60 points, from every sixth of them and `m` eigenpairs.
fn of_arcs(m: usize, mu: f64) -> Matrix {
    spectral(&columns(60, 6, arc(60)), &Ring::new(60, m).basis(), mu, 2).unwrap().coords
}

fn gap(found: &Matrix, expected: &Matrix) -> f64 {
    let [found, expected] = [found, expected].map(pairwise);
    (found - &expected).amax() / expected.amax()
}

#[test]
fn the_interpolant_satisfies_its_definition() {
    let (p, m) = (60, 25);
    let ring = Ring::new(p, m);
    let area = p as f64;
    let distances = columns(p, 6, arc(p));
    let centering = Matrix::identity(p, p).add_scalar(-1.0 / area);
    for mu in [0.01, 1.0, 1e4] {
        let vectors = &ring.vectors * area.sqrt();
        let at = vectors.select_rows(distances.landmarks());
        let energy: Vec<f64> = ring.values.iter().map(|v| v * area).collect();
        let normal = Matrix::from_diagonal(&energy.into()) + at.transpose() * &at * mu;
        let interpolant = &centering * vectors * normal.try_inverse().unwrap() * at.transpose() * mu;
        // The two largest eigenpairs of -1/2 J P S P' J.
        let gram =
            symmetric_eigen(&(&interpolant * distances.sq_block() * interpolant.transpose() * -0.5)).unwrap();
        let expected = Matrix::from_fn(p, 2, |i, k| gram.vectors[(i, k)] * gram.values[k].sqrt());
        assert!(gap(&of_arcs(m, mu), &expected) < 1e-9, "{mu}");
    }
}

#[test]
fn infinite_mu_interpolates_and_is_the_limit_of_large_mu() {
    let p = 60;
    let distances = columns(p, 6, chord(p));
    let found = spectral(&distances, &Ring::new(p, 25).basis(), f64::INFINITY, 2).unwrap();
    let at_samples = found.coords.select_rows(distances.landmarks());
    let expected = Matrix::from_fn(10, 10, |i, j| chord(p)(6 * i, 6 * j));
    assert!((pairwise(&at_samples) - expected).amax() < 1e-10);
    // With more samples than eigenvectors, least squares.
    for m in [25, 7, 9, 10] {
        assert!(gap(&of_arcs(m, 1e9), &of_arcs(m, f64::INFINITY)) < 1e-6, "{m}");
    }
}

#[test]
fn impossible_options_are_rejected() {
    let p = 20;
    let distances = columns(p, 2, arc(p));
    let embed = |m: usize, mu, dim| spectral(&distances, &Ring::new(p, m).basis(), mu, dim);
    for mu in [0.0, -1.0] {
        assert_eq!(embed(15, mu, 3), Err(NmdsError::BadSmoothness(mu)));
    }
    assert!(matches!(embed(15, f64::NAN, 3), Err(NmdsError::BadSmoothness { .. })));
    assert_eq!(embed(15, 1.0, 11), Err(NmdsError::BadDimension { dim: 11, limit: 10 }));
    assert_eq!(embed(3, 1.0, 3), Err(NmdsError::BadDimension { dim: 3, limit: 2 }));
    let other = Ring::new(19, 15);
    assert_eq!(
        spectral(&distances, &other.basis(), 1.0, 3),
        Err(NmdsError::PointMismatch { given: 19, n_points: 20 })
    );
    // A second function in the kernel is zero at all samples.
    let ring = Ring::new(p, 15);
    let mut vectors = ring.vectors.clone();
    vectors.column_mut(1).copy_from(&Matrix::from_fn(p, 1, |i, _| (i % 2) as f64 * 0.3));
    let mut values = ring.values.clone();
    values[1] = 0.0;
    let basis = SpectralBasis { values: &values, vectors: &vectors, masses: &ring.masses };
    let undetermined = spectral(&distances, &basis, 1.0, 3);
    assert_eq!(undetermined, Err(NmdsError::NotDetermined(10)));
}
