use canonform_nmds::*;
use linalg::{LandmarkDistances, Matrix};

use crate::support::{Cloud, landmark_distances, procrustes_free_gap, scaled};

fn low_rank(rank: usize) -> Regularization {
    Regularization::LowRank { rank: Some(rank) }
}

#[test]
fn points_in_space_are_exact_at_rank_five() {
    // Several groups of blocks, and a last block with fewer rows than columns.
    let cloud = Cloud::new(9 * 1024 + 3, 3, 1);
    let distances = landmark_distances(&cloud, 10);
    for rank in [low_rank(5), Regularization::Cur { rank: Some(5) }] {
        let embedding = nystrom(&distances, rank, 3).unwrap();
        assert!(procrustes_free_gap(&cloud, &embedding) < 1e-9, "{rank:?}");
        assert!(embedding.rank == 5 && embedding.negative_mass < 1e-12);
    }
    let at_four = nystrom(&distances, low_rank(4), 3).unwrap();
    assert!(procrustes_free_gap(&cloud, &at_four) > 1e-3, "rank 4 is too small for three dimensions");
}

#[test]
fn the_alpha_of_the_paper_depends_on_the_unit_of_length() {
    let distances = landmark_distances(&Cloud::new(200, 4, 2), 12);
    for scale in [1e-3, 1.0, 1e3] {
        let distances = scaled(&distances, scale);
        let sigma_1 = sample_eigenvalues(&distances).unwrap()[0];
        let by_name = Regularization::Rpi { alpha: RpiAlpha::Paper };
        let by_value = Regularization::Rpi { alpha: RpiAlpha::Relative(1.0 / sigma_1) };
        let [a, b] = [by_name, by_value].map(|by| nystrom(&distances, by, 3).unwrap());
        assert!((&a.coords - &b.coords).amax() < 1e-12 * b.coords.amax());
    }
}

#[test]
fn impossible_options_are_rejected_with_the_limit() {
    let distances = landmark_distances(&Cloud::new(20, 3, 3), 6);
    let embed = |regularization, dim| nystrom(&distances, regularization, dim);
    let low_rank = |rank| Regularization::LowRank { rank };
    for rank in [0, 7] {
        assert_eq!(embed(low_rank(Some(rank)), 3), Err(NmdsError::BadRank { rank, n_landmarks: 6 }));
    }
    assert_eq!(embed(low_rank(Some(2)), 3), Err(NmdsError::BadDimension { dim: 3, limit: 2 }));
    for alpha in [0.0, -1.0, f64::INFINITY] {
        let rpi = Regularization::Rpi { alpha: RpiAlpha::Relative(alpha) };
        assert_eq!(embed(rpi, 3), Err(NmdsError::BadAlpha(alpha)));
    }
}

/// Points in the plane, all pairs of whose twenty samples are used.
#[test]
fn eigenvalues_that_are_errors_count_only_if_other_points_confirm_them() {
    let cloud = Cloud::new(200, 2, 7);
    let rank = |elsewhere: f64| {
        let columns = Matrix::from_fn(200, 20, |i, j| {
            let share = if i < 20 { 1.0 } else { elsewhere };
            let error = ((i.min(j) * 31 + i.max(j) * 57) as f64).sin();
            cloud.distance(i, j) * (1.0 + 1e-10 * share * error)
        });
        let distances = LandmarkDistances::new((0..20).collect(), columns).unwrap();
        nystrom(&distances, Regularization::None, 2).unwrap().rank
    };
    assert_eq!(rank(50.0), 4);
    assert!(rank(1.0) > 4);
}

#[test]
fn a_search_begins_with_the_rank_that_is_given() {
    assert_eq!([Regularization::default(), low_rank(30)].map(|by| by.first_samples(3)), [8, 30]);
}

#[test]
fn the_strength_of_the_regularization_is_a_number_or_that_of_the_paper() {
    assert_eq!(["paper".parse(), "1e-8".parse()], [Ok(RpiAlpha::Paper), Ok(RpiAlpha::Relative(1e-8))]);
    assert!("half".parse::<RpiAlpha>().is_err());
}

#[test]
fn a_single_sample_gives_zero_coordinates() {
    let one = LandmarkDistances::new(vec![3], Matrix::from_fn(8, 1, |i, _| (i as f64 - 3.0).abs())).unwrap();
    for regularization in Regularization::all() {
        let embedding = nystrom(&one, regularization, 1).unwrap();
        assert_eq!(embedding.coords, Matrix::zeros(8, 1), "{regularization:?}");
    }
}
