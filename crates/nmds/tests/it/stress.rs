use canonform_nmds::*;
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};

use crate::support::{Cloud, circle, pairwise};

/// The stress of the paper and the normalized one by their definitions.
fn by_definition(coords: &Matrix, distances: &DistanceMatrix) -> [f64; 2] {
    let p = distances.n_points();
    let squares = Matrix::from_fn(p, p, |i, j| distances.get(i, j).powi(2));
    let centering = Matrix::identity(p, p).add_scalar(-1.0 / p as f64);
    let lengths = Matrix::from_row_slice(p, p, distances.as_slice());
    let of_paper = (coords * coords.transpose() + &centering * squares * &centering * 0.5).norm() / p as f64;
    [of_paper, (&lengths - pairwise(coords)).norm() / lengths.norm()]
}

#[test]
fn both_equal_their_definitions_and_that_of_the_paper_the_norm_of_the_omitted_eigenvalues() {
    let distances = circle(151);
    let coords = classical(&distances, 3, &()).unwrap().coords;
    let found = stress(&coords, &distances).unwrap();
    let expected = by_definition(&coords, &distances);
    assert!((found.value / expected[0] - 1.0).abs() < 1e-12);
    assert!((found.normalized / expected[1] - 1.0).abs() < 1e-12);
    let all = classical_full(&distances, 3).unwrap().eigenvalues;
    let rest = all[3..].iter().map(|v| v * v).sum::<f64>().sqrt() / 151.0;
    assert!((found.value / rest - 1.0).abs() < 1e-9);
    let large = DistanceMatrix::from_pairs(151, |i, j| 1024.0 * distances.get(i, j)).unwrap();
    assert_eq!(stress(&(coords * 1024.0), &large).unwrap().normalized, found.normalized);
    assert_eq!(stress(&Matrix::zeros(151, 3), &distances).unwrap().normalized, 1.0);
}

/// Different rows, all equally likely.
fn equally_likely(n_points: usize, m: usize, seed: u64) -> RowSample {
    RowSample::from_rows(sample_rows(n_points, m, seed), n_points)
}

/// Distances that are not Euclidean, their best embedding in the plane, and the distances from 8 of the points.
fn bent(p: usize) -> (DistanceMatrix, Matrix, LandmarkDistances) {
    let cloud = Cloud::new(p, 3, 21);
    let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(0.7)).unwrap();
    let coords = classical(&distances, 2, &()).unwrap().coords;
    let landmarks: Vec<usize> = (0..8).map(|j| j * p / 8).collect();
    let columns = Matrix::from_fn(p, 8, |i, j| distances.get(i, landmarks[j]));
    (distances, coords, LandmarkDistances::new(landmarks, columns).unwrap())
}

#[test]
fn estimates_from_all_rows_are_exact() {
    let (distances, coords, _) = bent(300);
    let exact = stress(&coords, &distances).unwrap();
    let all = estimate_stress(&coords, &distances, &equally_likely(300, 1000, 0)).unwrap();
    assert!((all.value / exact.value - 1.0).abs() < 1e-12 && all.n_rows == 300);
    assert!((all.normalized / exact.normalized - 1.0).abs() < 1e-12);
    assert!(all.interval[1] - all.interval[0] < 1e-9 * exact.value);
    assert_eq!(all.normalized_interval[0], all.normalized_interval[1]);
}

#[test]
fn estimates_are_unbiased_and_intervals_cover_the_exact_stress() {
    let (distances, coords, landmarks) = bent(300);
    let exact = stress(&coords, &distances).unwrap();
    type Draw<'a> = &'a dyn Fn(usize, u64) -> RowSample;
    let uniform: Draw<'_> = &|m, seed| equally_likely(300, m, seed);
    let guided: Draw<'_> = &|m, seed| RowSample::by_landmarks(&coords, &landmarks, m, seed).unwrap();
    for (name, draw, m) in [("uniform", uniform, 20), ("guided", guided, 4), ("guided", guided, 20)] {
        let runs = 300;
        let found: Vec<_> =
            (0..runs).map(|seed| estimate_stress(&coords, &distances, &draw(m, seed)).unwrap()).collect();
        let covered = |interval: &dyn Fn(&Stress) -> [f64; 2], value: f64| {
            let hits = found.iter().map(interval).filter(|[low, high]| (*low..=*high).contains(&value));
            hits.count() as f64 / runs as f64
        };
        let of_paper = covered(&|e| e.interval, exact.value);
        let normalized = covered(&|e| e.normalized_interval, exact.normalized);
        assert!(of_paper > 0.93 && normalized > 0.93, "{name} {m}: {of_paper} {normalized}");
        let mean_square = found.iter().map(|e| e.value.powi(2)).sum::<f64>() / runs as f64;
        assert!((mean_square / exact.value.powi(2) - 1.0).abs() < 0.05, "{name} {m}");
    }
}

#[test]
fn one_row_has_no_interval() {
    let (distances, coords, landmarks) = bent(50);
    for sample in [equally_likely(50, 1, 3), RowSample::by_landmarks(&coords, &landmarks, 1, 3).unwrap()] {
        let found = estimate_stress(&coords, &distances, &sample).unwrap();
        for interval in [found.interval, found.normalized_interval] {
            assert_eq!(interval, [0.0, f64::INFINITY]);
        }
    }
    let point = DistanceMatrix::from_rows(1, vec![0.0]).unwrap();
    let found = estimate_stress(&Matrix::zeros(1, 2), &point, &equally_likely(1, 4, 0)).unwrap();
    assert_eq!((found.value, found.interval), (0.0, [0.0; 2]));
}

#[test]
fn an_exact_embedding_has_no_stress() {
    let cloud = Cloud::new(60, 2, 4);
    let distances = DistanceMatrix::from_pairs(60, |i, j| cloud.distance(i, j)).unwrap();
    let coords = classical(&distances, 2, &()).unwrap().coords;
    let columns = Matrix::from_fn(60, 5, |i, j| distances.get(i, j));
    let landmarks = LandmarkDistances::new((0..5).collect(), columns).unwrap();
    let sample = RowSample::by_landmarks(&coords, &landmarks, 4, 0).unwrap();
    let found = estimate_stress(&coords, &distances, &sample).unwrap();
    assert!(found.value < 1e-6 && found.interval[1] < 1e-6, "{found:?}");
}

#[test]
fn intervals_follow_from_the_variance_between_rows_by_students_t() {
    let (distances, coords, _) = bent(300);
    for (m, quantile) in [(2, 31.821), (5, 3.747), (31, 2.457), (61, 2.390), (121, 2.358)] {
        let sample = equally_likely(300, m, 3);
        let found = estimate_stress(&coords, &distances, &sample).unwrap();
        let gap = |i: usize, j: usize| distances.get(i, j) - (coords.row(i) - coords.row(j)).norm();
        let sums = sample.rows().into_iter().map(|i| {
            let of_row = |term: &dyn Fn(usize) -> f64| (0..300).map(|j| term(j).powi(2)).sum::<f64>();
            [of_row(&|j| gap(i, j)), of_row(&|j| distances.get(i, j))]
        });
        let sums: Vec<[f64; 2]> = sums.collect();
        let [gaps, totals] = [0, 1].map(|k| sums.iter().map(|sum| sum[k]).sum::<f64>());
        let ratio = gaps / totals;
        let squares: f64 = sums.iter().map(|[gap, total]| (gap - ratio * total).powi(2)).sum();
        let m = m as f64;
        let deviation = (squares * m / (m - 1.0) * (1.0 - m / 300.0)).sqrt() / totals;
        let half = found.normalized_interval[1].powi(2) - ratio;
        assert!((half / deviation - quantile).abs() < 0.003, "{m} rows: {}", half / deviation);
    }
}
