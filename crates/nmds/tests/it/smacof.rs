use canonform_nmds::*;
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};

use crate::support::{Cloud, all_pairs, landmark_distances, pairwise, procrustes_free_gap};

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
fn the_stress_never_increases_and_is_that_of_the_coordinates() {
    let (distances, start) = problem(120, 0.7);
    for tolerance in [0.0, 1e-5] {
        let options = SmacofOptions { tolerance, ..Default::default() };
        let (embedding, report) = descended(&start, &distances, &options);
        let stress = &report.normalized_stress;
        assert!(stress.windows(2).all(|pair| pair[1] < pair[0]), "{stress:?}");
        assert!((stress[0] / normalized_stress(&start, &distances) - 1.0).abs() < 1e-9);
        let last = stress[report.iterations];
        assert!((last / normalized_stress(&embedding.coords, &distances) - 1.0).abs() < 1e-9);
        assert!(last < 0.9 * stress[0]);
    }
}

#[test]
fn an_exact_start_stays_and_a_perturbed_one_returns() {
    let cloud = Cloud::new(90, 3, 52);
    let distances = DistanceMatrix::from_pairs(90, |i, j| cloud.distance(i, j)).unwrap();
    let start = classical(&distances, 3, &()).unwrap();
    let (embedding, report) = descended(&start.coords, &distances, &SmacofOptions::default());
    assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9);
    assert_eq!(report.stop, SmacofStop::Converged);
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
    let none = run(0, 0.0);
    assert_eq!((none.iterations, none.stop), (0, SmacofStop::IterationLimit));
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

/// Distances from 30 of 300 points of a cloud, raised to a power, and their Nystrom scaling.
fn of_landmarks(power: f64) -> (LandmarkDistances, Matrix) {
    let cloud = Cloud::new(300, 4, 51);
    let columns = Matrix::from_fn(300, 30, |i, j| cloud.distance(i, j).powf(power));
    let distances = LandmarkDistances::new((0..30).collect(), columns).unwrap();
    let start = nystrom(&distances, &NystromOptions::default()).unwrap().coords;
    (distances, start)
}

fn fitted(start: &Matrix, rows: &LandmarkDistances, power: f64, steps: usize) -> (Embedding, f64) {
    let masses = masses(rows.n_points());
    let pairs = LandmarkPairs { landmarks: rows.landmarks(), rows, masses: &masses, power };
    let options = SmacofOptions { max_iterations: steps, tolerance: 0.0 };
    let (embedding, report) = smacof(start, &pairs, &options, &()).unwrap();
    (embedding, report.normalized_stress[report.iterations])
}

#[test]
fn distances_from_landmarks_in_space_stay_exact() {
    let cloud = Cloud::new(200, 3, 7);
    let distances = landmark_distances(&cloud, 20);
    let start = nystrom(&distances, &NystromOptions::default()).unwrap().coords;
    for power in [0.0, 1.0] {
        assert!(procrustes_free_gap(&cloud, &fitted(&start, &distances, power, 20).0) < 1e-6);
    }
}

#[test]
fn the_stress_of_landmarks_is_its_definition_and_never_increases() {
    let (distances, start) = of_landmarks(0.7);
    let (masses, columns) = (masses(300), distances.to_matrix().unwrap());
    for power in [0.0, 1.0] {
        let mut last = f64::INFINITY;
        for steps in [0, 1, 2, 5, 20] {
            let (found, stress) = fitted(&start, &distances, power, steps);
            let sum = |term: &dyn Fn(usize, usize, f64) -> f64| -> f64 {
                let weighted = |i: usize, s: usize| match columns[(i, s)] {
                    0.0 => 0.0,
                    d => masses[i] * d.powf(-power) * term(i, s, d),
                };
                (0..300).map(|i| (0..30).map(|s| weighted(i, s)).sum::<f64>()).sum()
            };
            let gap =
                |i: usize, s: usize, d: f64| (d - (found.coords.row(i) - found.coords.row(s)).norm()).powi(2);
            let expected = (sum(&gap) / sum(&|_, _, d| d * d)).sqrt();
            assert!((stress / expected - 1.0).abs() < 1e-9, "{power}, {steps}: {stress}, {expected}");
            assert!(stress < last, "{power}, {steps}: {stress} after {last}");
            last = stress;
        }
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
