use canonform_nmds::*;
use linalg::{DistanceMatrix, Matrix};

use crate::support::{Cloud, all_pairs, pairwise, procrustes_free_gap};

/// Distances of a cloud raised to a power, and their classical scaling.
fn problem(p: usize, power: f64) -> (DistanceMatrix, Matrix) {
    let cloud = Cloud::new(p, 4, 51);
    let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(power)).unwrap();
    let start = classical(&distances, 3, &()).unwrap().coords;
    (distances, start)
}

fn descended(
    start: &Matrix,
    distances: &DistanceMatrix,
    options: &SmacofOptions,
) -> (Embedding, SmacofReport) {
    all_pairs(distances, |pairs| smacof(start, pairs, options, &())).unwrap()
}

#[test]
fn a_perturbed_exact_embedding_returns() {
    let cloud = Cloud::new(90, 3, 52);
    let distances = DistanceMatrix::from_pairs(90, |i, j| cloud.distance(i, j)).unwrap();
    let start = classical(&distances, 3, &()).unwrap();
    let perturbed = start.coords.map_with_location(|i, j, x| x + 0.5 * ((7 * i + 3 * j) as f64).sin());
    let options = SmacofOptions { tolerance: 0.0, max_iterations: 2000 };
    let (embedding, _) = descended(&perturbed, &distances, &options);
    assert!(procrustes_free_gap(&cloud, &embedding) < 1e-6);
}

const ONE_STEP: SmacofOptions = SmacofOptions { max_iterations: 1, tolerance: 0.0 };

/// Compares distances, which do not depend on the principal axes of the result.
#[test]
fn a_step_of_all_pairs_is_the_guttman_transform() {
    let (distances, start) = problem(30, 0.7);
    let mut b = Matrix::from_fn(30, 30, |i, j| {
        if i == j { 0.0 } else { -distances.get(i, j) / (start.row(i) - start.row(j)).norm() }
    });
    for i in 0..30 {
        b[(i, i)] = -b.row(i).sum();
    }
    let (moved, report) = descended(&start, &distances, &ONE_STEP);
    assert_eq!(report.iterations, 1);
    assert!((pairwise(&moved.coords) - pairwise(&(b * &start / 30.0))).amax() < 1e-12);
}

/// Points that are no landmarks move at once, and then landmarks in turn.
#[test]
fn a_step_of_landmarks_is_its_definition() {
    let (distances, start) = problem(30, 0.7);
    let masses = masses(30);
    for (n, power) in [(30, 0.0), (30, 1.0), (8, 0.5)] {
        let landmarks: Vec<usize> = (0..n).map(|s| (11 * s) % 30).collect();
        let is_landmark = |i: usize| landmarks.contains(&i);
        let moved = |x: &Matrix, i: usize| {
            let (mut sum, mut total) = (x.row(i) * 0.0, 0.0);
            for j in (0..30).filter(|&j| j != i && (is_landmark(i) || is_landmark(j))) {
                let (d, apart) = (distances.get(i, j), x.row(i) - x.row(j));
                let mass = match (is_landmark(i), is_landmark(j)) {
                    (true, true) => masses[i] + masses[j],
                    (true, false) => masses[j],
                    (false, _) => masses[i],
                };
                let weight = mass * d.powf(-power);
                sum += (x.row(j) + &apart * (d / apart.norm())) * weight;
                total += weight;
            }
            sum / total
        };
        let mut expected = start.clone();
        for i in (0..30).filter(|&i| !is_landmark(i)) {
            expected.row_mut(i).copy_from(&moved(&start, i));
        }
        for &landmark in &landmarks {
            let to = moved(&expected, landmark);
            expected.row_mut(landmark).copy_from(&to);
        }
        let pairs = LandmarkPairs { landmarks: &landmarks, rows: &distances, masses: &masses, power };
        let (found, report) = smacof(&start, &pairs, &ONE_STEP, &()).unwrap();
        assert_eq!(report.iterations, 1);
        let gap = (pairwise(&found.coords) - pairwise(&expected)).amax();
        assert!(gap < 1e-12, "{n} landmarks, power {power}: {gap:e}");
    }
}

#[test]
fn the_iteration_limit_and_the_tolerance_stop_it() {
    let (distances, start) = problem(80, 0.7);
    let run = |max_iterations, tolerance| {
        descended(&start, &distances, &SmacofOptions { max_iterations, tolerance }).1
    };
    let cut = run(5, 0.0);
    assert_eq!((cut.iterations, cut.stop), (5, SmacofStop::IterationLimit));
    let (rough, fine) = (run(10_000, 1e-3), run(10_000, 1e-7));
    assert_eq!([rough.stop, fine.stop], [SmacofStop::Converged; 2]);
    assert!(rough.iterations < fine.iterations);
}

#[test]
fn coinciding_points_and_empty_dimensions_give_finite_coordinates() {
    let (distances, mut start) = problem(40, 0.7);
    let row = start.row(0).into_owned();
    start.row_mut(1).copy_from(&row);
    start.column_mut(2).fill(0.0);
    let (embedding, _) = descended(&start, &distances, &SmacofOptions::default());
    assert!(embedding.coords.iter().all(|x| x.is_finite()));
    assert!(embedding.coords.column(2).amax() < 1e-9);
}

fn masses(p: usize) -> Vec<f64> {
    (0..p).map(|i| 1.0 + (i % 5) as f64).collect()
}

#[test]
fn the_stress_is_its_definition_and_never_increases() {
    let (distances, start) = problem(120, 0.7);
    let (landmarks, equal, unequal): (Vec<usize>, _, _) = ((0..120).collect(), vec![1.0; 120], masses(120));
    for (n, masses, power, tolerance, most) in [
        (120, &equal, 0.0, 0.0, 0.9),
        (120, &equal, 0.0, 1e-5, 0.9),
        (30, &unequal, 0.0, 0.0, 1.0),
        (30, &unequal, 1.0, 0.0, 1.0),
    ] {
        let landmarks = &landmarks[..n];
        let stress_of = |coords: &Matrix| {
            let (mut sum, mut total) = (0.0, 0.0);
            for &s in landmarks {
                for (i, d) in distances.row(s).iter().enumerate().filter(|(_, d)| **d > 0.0) {
                    let weight = masses[i] * d.powf(-power);
                    sum += weight * (d - (coords.row(i) - coords.row(s)).norm()).powi(2);
                    total += weight * d * d;
                }
            }
            f64::sqrt(sum / total)
        };
        let options = SmacofOptions { tolerance, ..Default::default() };
        let pairs = LandmarkPairs { landmarks, rows: &distances, masses, power };
        let (found, report) = smacof(&start, &pairs, &options, &()).unwrap();
        let stress = &report.normalized_stress;
        for (stress, coords) in [(stress[0], &start), (stress[report.iterations], &found.coords)] {
            assert!((stress / stress_of(coords) - 1.0).abs() < 1e-9, "{n}, {power}, {tolerance}");
        }
        assert!(
            stress.is_sorted_by(|a, b| a > b) && stress[report.iterations] < most * stress[0],
            "{stress:?}"
        );
    }
}

#[test]
fn mismatched_arguments_are_rejected() {
    let (distances, start) = problem(20, 1.0);
    let error = |start: &Matrix, masses: &[f64], tolerance| {
        let pairs = LandmarkPairs { landmarks: &[0, 7], rows: &distances, masses, power: 0.0 };
        smacof(start, &pairs, &SmacofOptions { tolerance, ..Default::default() }, &()).unwrap_err()
    };
    let short = start.rows(0, 19).into_owned();
    let mismatch = NmdsError::PointMismatch { given: 19, n_points: 20 };
    assert_eq!(error(&short, &[1.0; 19], 1e-5), mismatch);
    assert_eq!(error(&start, &[1.0; 19], 1e-5), mismatch);
    let flat = Matrix::zeros(20, 0);
    assert_eq!(error(&flat, &[1.0; 20], 1e-5), NmdsError::BadDimension { dim: 0, limit: 20 });
    assert_eq!(error(&start, &[1.0; 20], -1.0), NmdsError::BadTolerance(-1.0));
}
