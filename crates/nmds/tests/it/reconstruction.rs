use canonform_nmds::*;
use linalg::{DistanceMatrix, LandmarkDistances, Matrix, SymmetricEigen, pseudo_inverse, symmetric_eigen};

use crate::support::{Cloud, scaled};

/// Distances of a cloud that are not Euclidean, and the columns of the first n points.
fn problem(p: usize, n: usize) -> (DistanceMatrix, LandmarkDistances) {
    let cloud = Cloud::new(p, 3, 41);
    let all = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(0.7)).unwrap();
    let columns = Matrix::from_fn(p, n, |i, j| all.get(i, j));
    (all, LandmarkDistances::new((0..n).collect(), columns).unwrap())
}

const RPI: Regularization = Regularization::Rpi { alpha: RpiAlpha::Relative(1e-10) };

fn low_rank(rank: usize) -> Regularization {
    Regularization::LowRank { rank: Some(rank) }
}

fn cur(rank: usize) -> Regularization {
    Regularization::Cur { rank: Some(rank) }
}

/// The eigenpairs of the `rank` largest magnitudes.
fn by_magnitude(a: &Matrix, rank: usize) -> SymmetricEigen {
    let eigen = symmetric_eigen(a).unwrap();
    let mut order: Vec<usize> = (0..a.nrows()).collect();
    order.sort_by(|i, j| eigen.values[*j].abs().total_cmp(&eigen.values[*i].abs()));
    eigen.select(&order[..rank])
}

#[test]
fn errors_match_their_definition_in_any_unit() {
    [1e-3, 1.0, 1e3].into_iter().for_each(match_their_definition);
}

fn match_their_definition(scale: f64) {
    let (p, n) = (90, 8);
    let (all, columns) = problem(p, n);
    let all = DistanceMatrix::from_pairs(p, |i, j| scale * all.get(i, j)).unwrap();
    let reconstruction = Reconstruction::new(&scaled(&columns, scale), &all).unwrap();
    let squares = Matrix::from_fn(p, p, |i, j| all.get(i, j).powi(2));
    let r = squares.columns(0, n).into_owned();
    let s = squares.view((0, 0), (n, n)).into_owned();
    let check = |approximation: Matrix, error: ReconstructionError| {
        let gap = approximation - &squares;
        assert!((error.relative / (gap.norm() / squares.norm()) - 1.0).abs() < 1e-9);
        assert!((error.mean_square / (gap.norm_squared() / (p * p) as f64) - 1.0).abs() < 1e-9);
    };
    let inverse = pseudo_inverse(&s).unwrap();
    check(&r * &inverse * r.transpose(), reconstruction.error(Regularization::None).unwrap());
    let kept = by_magnitude(&s, 5);
    let diagonal = |f: &dyn Fn(f64) -> f64, values: &[f64]| {
        Matrix::from_diagonal(&values.iter().map(|v| f(*v)).collect::<Vec<_>>().into())
    };
    let c = &r * &kept.vectors;
    check(
        &c * diagonal(&f64::recip, &kept.values) * c.transpose(),
        reconstruction.error(low_rank(5)).unwrap(),
    );
    let u = pseudo_inverse(&s.columns(0, 5).into_owned()).unwrap();
    check(r.columns(0, 5) * u * r.transpose(), reconstruction.error(cur(5)).unwrap());
    let whole = by_magnitude(&s, n);
    let c = &r * &whole.vectors;
    let alpha = 1e-10 * whole.values[0].powi(4);
    let rpi = diagonal(&|v| v.signum() * v.abs() / (v * v + alpha / (v * v)), &whole.values);
    check(&c * rpi * c.transpose(), reconstruction.error(RPI).unwrap());
    check(&r * pseudo_inverse(&r).unwrap() * &squares, reconstruction.best_projection());
}

#[test]
fn the_factor_is_exact_at_samples_if_no_eigenpair_is_dropped() {
    let (all, columns) = problem(80, 20);
    let (z, n_positive) = low_rank_factor(&columns, 20).unwrap();
    let signs = Matrix::from_fn(20, 20, |i, j| match i == j {
        true if i < n_positive => 1.0,
        true => -1.0,
        false => 0.0,
    });
    let approximated = &z * signs * z.transpose();
    let largest = columns.max().powi(2);
    for (i, j) in (0..20).flat_map(|i| (0..80).map(move |j| (i, j))) {
        let gap = approximated[(i, j)] - all.get(i, j).powi(2);
        assert!(gap.abs() < 1e-9 * largest, "{i} {j}: {gap}");
    }
}

#[test]
fn mismatched_arguments_are_rejected() {
    let (all, columns) = problem(20, 5);
    let (other, _) = problem(21, 5);
    let mismatch = NmdsError::PointMismatch { given: 20, n_points: 21 };
    assert_eq!(Reconstruction::new(&columns, &other).unwrap_err(), mismatch);
    let nothing = LandmarkDistances::new(vec![0, 1], Matrix::zeros(20, 2)).unwrap();
    assert_eq!(Reconstruction::new(&nothing, &all).unwrap_err(), NmdsError::NoExtent(20));
    let reconstruction = Reconstruction::new(&columns, &all).unwrap();
    let bad = Err(NmdsError::BadRank { rank: 6, n_landmarks: 5 });
    assert_eq!(reconstruction.error(low_rank(6)), bad);
}
