use canonform_nmds::*;
use linalg::{LandmarkDistances, Matrix};

use crate::support::{Cloud, landmark_distances, procrustes_free_gap, scaled};

const ALL: [Regularization; 5] = [
    Regularization::LowRank { rank: None },
    Regularization::Rpi { alpha: RpiAlpha::Relative(1e-10) },
    Regularization::Rpi { alpha: RpiAlpha::Relative(1e-8) },
    Regularization::None,
    Regularization::Cur { rank: None },
];

fn options(regularization: Regularization) -> NystromOptions {
    NystromOptions { regularization, ..Default::default() }
}

fn low_rank(rank: usize) -> NystromOptions {
    options(Regularization::LowRank { rank: Some(rank) })
}

#[test]
fn points_in_space_are_exact_at_rank_five() {
    // The larger cloud takes several groups of blocks, and a last block with fewer rows than columns.
    for p in [300, 9 * 1024 + 3] {
        let cloud = Cloud::new(p, 3, 1);
        let distances = landmark_distances(&cloud, 10);
        for rank in [Regularization::LowRank { rank: Some(5) }, Regularization::Cur { rank: Some(5) }] {
            let embedding = nystrom(&distances, &options(rank)).unwrap();
            assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9, "{p} points, {rank:?}");
            assert_eq!(embedding.rank, 5);
            assert!(embedding.negative_mass < 1e-12);
        }
        let at_four = nystrom(&distances, &low_rank(4)).unwrap();
        assert!(procrustes_free_gap(&cloud, &at_four) > 1e-3, "rank 4 is too small for three dimensions");
    }
}

/// Points in the plane with a little noise: four eigenvalues are far above the rest.
fn gapped() -> LandmarkDistances {
    let cloud = Cloud::new(150, 2, 4);
    let noise = |i: usize, j: usize| 1e-4 * ((i + j) as f64 * (1 + i * j) as f64).sin();
    let distance = |i: usize, j: usize| {
        if i == j { 0.0 } else { (cloud.distance(i, j).powi(2) + noise(i, j)).max(0.0).sqrt() }
    };
    LandmarkDistances::new((0..15).collect(), Matrix::from_fn(150, 15, distance)).unwrap()
}

#[test]
fn the_regularized_pseudo_inverse_lies_between_none_and_low_rank() {
    let distances = gapped();
    let embed =
        |regularization| nystrom(&distances, &NystromOptions { regularization, dim: 2 }).unwrap().coords;
    let gap = |a: &Matrix, b: &Matrix| (a - b).amax() / b.amax();
    let none = embed(Regularization::None);
    let four = embed(Regularization::LowRank { rank: Some(4) });
    let between_ends = gap(&none, &four);
    let rpi = |c| embed(Regularization::Rpi { alpha: RpiAlpha::Relative(c) });
    // Between the fourth powers of the eigenvalues on either side of the gap.
    let eigenvalues = sample_eigenvalues(&distances).unwrap();
    let ratio = |i: usize| (eigenvalues[i] / eigenvalues[0]).abs();
    let between = (ratio(3) * ratio(4)).powi(2);
    let ends = [gap(&rpi(1e-35), &none), gap(&rpi(between), &four)];
    assert!(between_ends > 1e-6 && ends.iter().all(|end| *end < 1e-2 * between_ends), "{ends:?}");
}

#[test]
fn the_alpha_of_the_paper_depends_on_the_unit_of_length() {
    let distances = landmark_distances(&Cloud::new(200, 4, 2), 12);
    for scale in [1e-3, 1.0, 1e3] {
        let distances = scaled(&distances, scale);
        let sigma_1 = sample_eigenvalues(&distances).unwrap()[0];
        let by_name = options(Regularization::Rpi { alpha: RpiAlpha::Paper });
        let by_value = options(Regularization::Rpi { alpha: RpiAlpha::Relative(1.0 / sigma_1) });
        let (a, b) = (nystrom(&distances, &by_name).unwrap(), nystrom(&distances, &by_value).unwrap());
        assert!((&a.coords - &b.coords).amax() < 1e-12 * b.coords.amax());
    }
}

#[test]
fn impossible_options_are_rejected_with_the_limit() {
    let distances = landmark_distances(&Cloud::new(20, 3, 3), 6);
    let embed = |regularization, dim| nystrom(&distances, &NystromOptions { regularization, dim });
    let low_rank = |rank| Regularization::LowRank { rank };
    let cur = |rank| Regularization::Cur { rank };
    for ranked in [low_rank, cur] {
        assert_eq!(embed(ranked(Some(7)), 3), Err(NmdsError::BadRank { rank: 7, n_landmarks: 6 }));
        assert_eq!(embed(ranked(Some(0)), 3), Err(NmdsError::BadRank { rank: 0, n_landmarks: 6 }));
        assert_eq!(embed(ranked(Some(2)), 3), Err(NmdsError::BadDimension { dim: 3, limit: 2 }));
    }
    for alpha in [0.0, -1.0, f64::INFINITY] {
        let rpi = Regularization::Rpi { alpha: RpiAlpha::Relative(alpha) };
        assert_eq!(embed(rpi, 3), Err(NmdsError::BadAlpha(alpha)));
    }
}

#[test]
fn a_search_begins_with_the_rank_that_is_given() {
    assert_eq!([NystromOptions::default(), low_rank(30)].map(|options| options.first_samples()), [8, 30]);
}

#[test]
fn a_single_sample_gives_zero_coordinates() {
    let one = LandmarkDistances::new(vec![3], Matrix::from_fn(8, 1, |i, _| (i as f64 - 3.0).abs())).unwrap();
    for regularization in ALL {
        let embedding = nystrom(&one, &NystromOptions { regularization, dim: 1 }).unwrap();
        assert_eq!(embedding.coords, Matrix::zeros(8, 1), "{regularization:?}");
    }
}
