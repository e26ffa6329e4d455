//! Laws of embeddings, on distances of meshes and through the whole pipeline.

use std::sync::LazyLock;

use canonform::Surface;
use canonform::embed::{EmbedMethod, FormOptions, Samples, StressChoice, StressKind, embed};
use datasets::{CreatureOptions, Family};
use linalg::DistanceMatrix;
use nmds::{Reconstruction, Regularization, SmacofOptions, SpectralBasis, paper_stress, stress};

use crate::support::{SHAPES, all_pairs, body, measured, surface};

/// A cat and all its distances.
static CAT: LazyLock<(Surface, DistanceMatrix)> = LazyLock::new(|| {
    let surface = surface(&body(Family::Cat));
    let distances = all_pairs(&surface);
    (surface, distances)
});

#[test]
fn the_default_stress_costs_few_rows_and_its_intervals_contain_the_exact_one() {
    intervals_contain_the_exact_stress(4, 9);
}

#[test]
#[ignore = "slow: make test-all"]
fn intervals_of_the_stress_contain_the_exact_one_for_95_in_100_shapes() {
    intervals_contain_the_exact_stress(1, 38);
}

/// Asserts that for `least` shapes or more, of 40 every `step`th, the interval holds the exact stress.
fn intervals_contain_the_exact_stress(step: usize, least: usize) {
    let creatures =
        CreatureOptions { n_families: 5, n_poses: 2, n_vertices: 1000, ..CreatureOptions::default() };
    let creatures = datasets::creatures(&creatures).unwrap();
    let shapes = SHAPES.iter().chain(&creatures);
    let (mut within, mut all, mut error) = ([0; 2], 0, 0.0);
    for (n, shape) in [20, 60, 100].into_iter().cycle().zip(shapes.step_by(step)) {
        let options = FormOptions { samples: Samples::Count(n), ..FormOptions::default() };
        let surface = surface(&shape.mesh);
        let stress = |choice| measured(&surface, &options, choice).report.stress.unwrap();
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
    println!("{within:?} of {all} intervals, normalized stress off by {:.1} %", 100.0 * error / all as f64);
    assert!(all == 40 / step && within.iter().all(|n| *n >= least), "{within:?} of {all}");
}

/// All methods whose coordinates are lengths, with all their options.
fn methods() -> Vec<EmbedMethod> {
    let nystrom = Regularization::all().map(|regularization| EmbedMethod::Nystrom { regularization });
    let descent = SmacofOptions { max_iterations: 10, ..SmacofOptions::default() };
    let smacof = EmbedMethod::Smacof { regularization: Regularization::default(), descent };
    let spectral = EmbedMethod::Spectral { eigenvectors: 60, mu: SpectralBasis::MU };
    nystrom.into_iter().chain([EmbedMethod::Classical, EmbedMethod::Landmark, spectral, smacof]).collect()
}

#[test]
fn classical_scaling_has_the_lowest_stress_and_smacof_the_lowest_normalized_stress() {
    let (surface, distances) = &*CAT;
    let coords = |method: EmbedMethod| {
        let options = FormOptions { method, ..FormOptions::default() };
        embed(surface, &options, &()).unwrap().embedding.coords
    };
    let optimum = paper_stress(&coords(EmbedMethod::Classical), distances).unwrap();
    let descended = methods().into_iter().find(|method| method.name() == "smacof").map(coords).unwrap();
    let best = stress(&descended, distances).unwrap().normalized;
    for method in methods() {
        let coords = coords(method.clone());
        let found = stress(&coords, distances).unwrap();
        assert!(found.value > optimum * (1.0 - 1e-12), "{method:?}: {found:?} {optimum}");
        assert!(found.normalized >= best, "{method:?}");
    }
}

/// Fig. 5 of the paper: with errors in the distances, small eigenvalues are harmful.
#[test]
fn the_best_rank_is_between_the_extremes_and_beats_cur() {
    let (surface, distances) = &*CAT;
    let options = FormOptions { samples: Samples::Count(60), ..FormOptions::default() };
    let samples = embed(surface, &options, &()).unwrap().distances;
    let reconstruction = Reconstruction::new(&samples, distances).unwrap();
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
