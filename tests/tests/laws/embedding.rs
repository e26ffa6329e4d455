//! Laws of embeddings, on distances of meshes and through the whole pipeline.

use canonform::compare::embedded_distances;
use canonform::embed::{EmbedMethod, FormOptions, Samples, StressChoice, StressKind};
use datasets::{ArticulatedOptions, CreatureOptions, Family, articulated};
use geodesics::{FirstSample, Sampling, farthest_point_sampling};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use mesh::shapes;
use nalgebra::Point3;
use nmds::{
    Bandwidth, NystromOptions, Reconstruction, Regularization, RowSample, SmacofOptions, SpectralOptions,
    classical, classical_full, estimate_stress, normalized_stress, nystrom, paper_stress, stress,
};

use crate::support::{body, embedded, gap, marching, measured, moved};

/// The columns of some points of a matrix of distances.
fn landmark_columns(distances: &DistanceMatrix, landmarks: Vec<usize>) -> LandmarkDistances {
    let p = distances.n_points();
    let values: Vec<f64> = landmarks.iter().flat_map(|&l| distances.row(l).iter().copied()).collect();
    LandmarkDistances::new(landmarks, Matrix::from_vec(p, values.len() / p, values)).unwrap()
}

fn straight_distances(points: &[nalgebra::Point3<f64>]) -> DistanceMatrix {
    DistanceMatrix::from_pairs(points.len(), |i, j| (points[i] - points[j]).norm()).unwrap()
}

#[test]
fn all_points_as_samples_equal_classical_scaling() {
    let mesh = shapes::torus(14, 9, 2.0, 0.7);
    let solver = marching().prepare(mesh.intrinsic(), &()).unwrap();
    let distances = solver.distance_matrix().unwrap();
    let p = distances.n_points();
    let all = landmark_columns(&distances, (0..p).collect());
    let sampled = nystrom(&all, &NystromOptions { regularization: Regularization::None, dim: 3 }).unwrap();
    let full = classical_full(&distances, 3).unwrap();
    let pairs = |coords: &Matrix| embedded_distances(coords).unwrap();
    let gap_pairs = gap(pairs(&sampled.coords).as_slice(), pairs(&full.coords).as_slice());
    let gap_values = gap(&sampled.eigenvalues[..3], &full.eigenvalues[..3]);
    println!("coordinates {gap_pairs:.1e}, eigenvalues {gap_values:.1e}");
    assert!(gap_pairs < 1e-9 && gap_values < 1e-9, "{gap_pairs:e} {gap_values:e}");
}

#[test]
fn more_samples_approach_the_optimal_stress_from_above() {
    let mesh = body(Family::Cat);
    let solver = marching().prepare(mesh.intrinsic(), &()).unwrap();
    let distances = solver.distance_matrix().unwrap();
    let optimum = paper_stress(&classical(&distances, 3, &()).unwrap().coords, &distances).unwrap();
    let excess = |n: usize| {
        let samples = farthest_point_sampling(solver.as_ref(), n, FirstSample::default()).unwrap();
        let embedding = nystrom(&samples, &NystromOptions::default()).unwrap();
        paper_stress(&embedding.coords, &distances).unwrap() / optimum - 1.0
    };
    let [few, many] = [10, 100].map(excess);
    println!("above classical scaling: {few:.2e} with 10 samples, {many:.2e} with 100");
    assert!(many > -1e-12 && many < 0.003 && many < few && few < 0.2, "{few} {many}");
}

#[test]
fn the_interval_of_the_estimated_stress_contains_the_exact_one() {
    let mesh = body(Family::Cat);
    let stress = |choice| measured(&mesh, &FormOptions::default(), choice).report.stress.unwrap();
    let exact = stress(StressChoice::Exact);
    let estimate = stress(StressChoice::Estimate);
    assert_eq!((exact.kind, estimate.kind), (StressKind::Exact, StressKind::Estimated));
    let [low, high] = estimate.interval;
    println!("exact {}, estimated {} in {low}..{high}", exact.value, estimate.value);
    assert!(low <= exact.value && exact.value <= high);
    assert!((estimate.value / exact.value - 1.0).abs() < 0.1);
}

/// The level is 95 %. A mesh whose rows have rare large residuals may have less, so it holds over all meshes.
#[test]
#[ignore = "slow: make test-all"]
fn intervals_of_the_estimated_stress_contain_the_exact_one_as_often_as_they_say() {
    let mut torus = shapes::torus(40, 20, 2.0, 0.7);
    torus.positions.iter_mut().for_each(|p| p.coords *= 1.0 + 0.3 * (-(p.x - 2.0).powi(2)).exp());
    // A flat sheet has no stress but rounding.
    let mut sheet = shapes::jittered_grid(25, 30, 0.1, 0.2, 7);
    sheet
        .positions
        .iter_mut()
        .for_each(|p| p.z = (-2.0 * (*p - Point3::new(1.0, 1.7, 0.0)).norm_squared()).exp());
    let meshes = Family::all().map(body).into_iter().chain([
        torus,
        shapes::icosphere(3),
        sheet,
        shapes::cylinder(24, 30, 1.0, 3.0),
    ]);
    // Of the paper's stress and the normalised one.
    let (mut covered, mut drawn) = ([0; 2], 0);
    for (number, mesh) in meshes.enumerate() {
        let solver = marching().prepare(mesh.intrinsic(), &()).unwrap();
        let distances = solver.distance_matrix().unwrap();
        for (n, m) in [(10, 3), (20, 4), (40, 8), (100, 20)] {
            let samples = farthest_point_sampling(solver.as_ref(), n, FirstSample::default()).unwrap();
            let coords = nystrom(&samples, &NystromOptions::default()).unwrap().coords;
            let exact = stress(&coords, &distances).unwrap();
            let exact = [exact.value, exact.normalized];
            let runs = 100;
            let (mut here, mut width, mut error) = ([0; 2], [0.0; 2], [0.0; 2]);
            for seed in 0..runs {
                let rows = RowSample::by_landmarks(&coords, &samples, 1.0, m, seed).unwrap();
                let found = estimate_stress(&coords, &distances, &rows).unwrap();
                let values = [(found.value, found.interval), (found.normalized, found.normalized_interval)];
                for (i, (value, [low, high])) in values.into_iter().enumerate() {
                    here[i] += u64::from((low..=high).contains(&exact[i]));
                    width[i] += 50.0 * (high - low) / exact[i] / runs as f64;
                    error[i] += (value / exact[i] - 1.0).powi(2) / runs as f64;
                }
            }
            let error = error.map(|square| 100.0 * square.sqrt());
            println!(
                "mesh {number}, {n} samples, {m} rows: {here:?} of {runs}, +-{width:.1?} %, off by {error:.1?} %"
            );
            assert!(
                here[0] >= 80 && here[1] >= 80,
                "mesh {number}, {n} samples, {m} rows: {here:?} of {runs}"
            );
            covered = [covered[0] + here[0], covered[1] + here[1]];
            drawn += runs;
        }
    }
    println!("{covered:?} of {drawn} intervals contain the exact stress");
    assert!(covered.iter().all(|n| *n as f64 >= 0.95 * drawn as f64), "{covered:?} of {drawn}");
}

#[test]
fn the_default_stress_costs_few_rows_and_its_intervals_contain_the_exact_one() {
    intervals_contain_the_exact_stress(2, 18);
}

#[test]
#[ignore = "slow: make test-all"]
fn intervals_of_the_stress_contain_the_exact_one_for_95_in_100_shapes() {
    intervals_contain_the_exact_stress(1, 38);
}

/// Asserts that for `least` shapes or more, of 40 every `step`th, the interval holds the exact stress.
fn intervals_contain_the_exact_stress(step: usize, least: usize) {
    let of = ArticulatedOptions { n_vertices: 1000, ..ArticulatedOptions::default() };
    let creatures =
        CreatureOptions { n_families: 5, n_poses: 2, n_vertices: 1000, ..CreatureOptions::default() };
    let shapes = articulated(&of).unwrap().into_iter().chain(datasets::creatures(&creatures).unwrap());
    let (mut within, mut all, mut error) = ([0; 2], 0, 0.0);
    for (n, shape) in [20, 60, 100].into_iter().cycle().zip(shapes.step_by(step)) {
        let options = FormOptions { samples: Samples::Count(n), ..FormOptions::default() };
        let stress = |choice| measured(&shape.mesh, &options, choice).report.stress.unwrap();
        let [exact, found] = [StressChoice::Exact, StressChoice::Auto].map(stress);
        assert!(
            found.kind == StressKind::Estimated && found.rows <= n / 5,
            "{} rows for {n} samples",
            found.rows
        );
        let [low, high] = found.interval;
        within[0] += usize::from((low..=high).contains(&exact.value));
        let [low, high] = found.normalized_interval;
        within[1] += usize::from((low..=high).contains(&exact.normalized));
        error += (found.normalized / exact.normalized - 1.0).abs();
        all += 1;
    }
    println!("{within:?} of {all} intervals, normalised stress off by {:.1} %", 100.0 * error / all as f64);
    assert!(all == 40 / step && within.iter().all(|n| *n >= least), "{within:?} of {all}");
}

#[test]
fn exact_methods_reproduce_a_flat_sheet() {
    let sheet = shapes::grid(17, 12, 0.5);
    let flat = straight_distances(&sheet.positions);
    let descent = SmacofOptions::default();
    let rank = Regularization::Cur { rank: Some(4) };
    for method in [
        EmbedMethod::Classical,
        EmbedMethod::low_rank(4),
        EmbedMethod::Nystrom { regularization: rank },
        EmbedMethod::Landmark,
        EmbedMethod::Smacof { regularization: rank, descent },
    ] {
        let options = FormOptions { method, dim: 2, ..FormOptions::default() };
        let result = embedded(&sheet, &options);
        let found = embedded_distances(&result.embedding.coords).unwrap();
        let gap = gap(found.as_slice(), flat.as_slice());
        println!("{} on a sheet: largest error {gap:.1e}", result.report.method);
        assert!(gap < 1e-9, "{}: {gap:e}", result.report.method);
    }
}

/// All methods, with all options that do not depend on the unit of length.
fn methods() -> Vec<EmbedMethod> {
    let nystrom = Regularization::all().map(|regularization| EmbedMethod::Nystrom { regularization });
    let descent = SmacofOptions { max_iterations: 10, ..SmacofOptions::default() };
    let smacof = EmbedMethod::Smacof { regularization: Regularization::default(), descent };
    let kernel = [Bandwidth::Mean, Bandwidth::Median, Bandwidth::Max]
        .map(|bandwidth| EmbedMethod::KernelPca { rank: None, bandwidth });
    let spectral = EmbedMethod::Spectral { eigenvectors: 60, mu: SpectralOptions::default().mu };
    let others = [EmbedMethod::Classical, EmbedMethod::Landmark, spectral, smacof];
    nystrom.into_iter().chain(kernel).chain(others).collect()
}

#[test]
fn no_method_depends_on_the_unit_of_length() {
    let mesh = body(Family::Cat);
    let embed = |mesh: &_, method: &EmbedMethod, sampling| {
        let samples = Samples::Count(100);
        let options = FormOptions { method: method.clone(), sampling, samples, ..FormOptions::default() };
        measured(mesh, &options, StressChoice::Estimate)
    };
    let samplings = [Sampling::Farthest, Sampling::Random, Sampling::MinVariance];
    let defaults = samplings.map(|sampling| (EmbedMethod::default(), sampling));
    for (method, sampling) in methods().into_iter().map(|m| (m, Sampling::Farthest)).chain(defaults) {
        let base = embed(&mesh, &method, sampling);
        for scale in [1e-3, 1e3] {
            let other = embed(&moved(&mesh, |point| point * scale), &method, sampling);
            assert_eq!(other.report.samples, base.report.samples, "{method:?} {sampling:?}");
            let length = if method.has_unit() { scale } else { 1.0 };
            let coords = &other.embedding.coords / length;
            let gap = gap(coords.as_slice(), base.embedding.coords.as_slice());
            assert!(gap < 1e-9, "{method:?} {sampling:?} at {scale}: {gap:e}");
            assert!((other.report.negative_mass - base.report.negative_mass).abs() < 1e-9, "{method:?}");
            if let [Some(a), Some(b)] = [&other, &base].map(|e| e.report.stress.as_ref()) {
                let ratio = a.value / length.powi(2) / b.value;
                assert!((ratio - 1.0).abs() < 1e-9, "{method:?} {sampling:?} at {scale}: {ratio}");
            }
        }
    }
}

#[test]
fn classical_scaling_has_the_lowest_stress_and_smacof_the_lowest_normalized_stress() {
    let mesh = body(Family::Cat);
    let solver = marching().prepare(mesh.intrinsic(), &()).unwrap();
    let distances = solver.distance_matrix().unwrap();
    let coords = |method: EmbedMethod| {
        let options = FormOptions { method, ..FormOptions::default() };
        embedded(&mesh, &options).embedding.coords
    };
    let optimum = paper_stress(&coords(EmbedMethod::Classical), &distances).unwrap();
    let descended = methods().into_iter().find(|method| method.name() == "smacof").map(coords).unwrap();
    let best = normalized_stress(&descended, &distances);
    for method in methods().into_iter().filter(EmbedMethod::has_unit) {
        let coords = coords(method.clone());
        let stress = paper_stress(&coords, &distances).unwrap();
        assert!(stress > optimum * (1.0 - 1e-12), "{method:?}: {stress} {optimum}");
        assert!(normalized_stress(&coords, &distances) >= best, "{method:?}");
    }
}

/// Fig. 5 of the paper: with errors in the distances, small eigenvalues are harmful.
#[test]
fn the_best_rank_is_between_the_extremes_and_beats_cur() {
    let mesh = body(Family::Cat);
    let solver = marching().prepare(mesh.intrinsic(), &()).unwrap();
    let distances = solver.distance_matrix().unwrap();
    let samples = farthest_point_sampling(solver.as_ref(), 60, FirstSample::default()).unwrap();
    let reconstruction = Reconstruction::new(&samples, &distances).unwrap();
    let error = |regularization| reconstruction.error(regularization).unwrap().relative;
    let ranks = [5, 10, 20, 30, 40, 50, 60];
    let low_rank = ranks.map(|n1| error(Regularization::LowRank { rank: Some(n1) }));
    let cur = ranks.map(|n1| error(Regularization::Cur { rank: Some(n1) }));
    let lowest = |errors: [f64; 7]| errors.into_iter().fold(f64::INFINITY, f64::min);
    println!("low-rank {low_rank:?}, CUR {cur:?}, best {:.1e}", reconstruction.best_projection().relative);
    assert!(lowest(low_rank) < low_rank[0].min(low_rank[6]) / 2.0);
    assert!(lowest(low_rank) < lowest(cur));
    assert!((low_rank[6] / cur[6] - 1.0).abs() < 1e-6, "both invert the whole sample matrix");
    assert!(reconstruction.best_projection().relative < lowest(low_rank));
}
