use canonform_nmds::*;
use linalg::{LandmarkDistances, Matrix};

use crate::support::Cloud;

type Found = (Embedding, LandmarkDistances, SamplesReport);

/// A search by distances that are not Euclidean, raised to a power below 1, in some unit.
fn search(p: usize, power: f64, unit: f64, limit: usize, seed: u64) -> Found {
    let cloud = Cloud::new(p, 3, 11);
    let columns =
        |of: &[usize]| Matrix::from_fn(p, of.len(), |i, j| unit * cloud.distance(i, of[j]).powf(power));
    let landmarks = |n: usize| {
        let landmarks: Vec<usize> = (0..n.min(p)).map(|i| (i * 37) % p).collect();
        Ok(LandmarkDistances::new(landmarks.clone(), columns(&landmarks)).unwrap())
    };
    let regularization = Regularization::default();
    let embed = |distances: &LandmarkDistances| nystrom(distances, regularization, 3);
    let search = SampleSearch { first: regularization.first_samples(3), limit, seed, embed: &embed };
    search.run::<NmdsError>(landmarks, |rows| Ok(columns(rows))).unwrap()
}

#[test]
fn a_search_ends_when_twice_the_samples_do_not_help() {
    let (_, distances, report) = search(240, 0.8, 1.0, 200, 0);
    assert_eq!(report.stop, SampleStop::Settled);
    let trials = report.tried;
    assert_eq!(trials.last().unwrap().n_samples, distances.n_landmarks());
    // The first whose stress is within 1 % of the last, and the last whose stress is not that much lower than with half of its samples.
    let is_enough = |few: &SampleTrial, many: &SampleTrial| few.stress <= 1.01 * many.stress;
    let sufficient = trials.iter().find(|few| is_enough(few, &trials[trials.len() - 1])).unwrap();
    assert_eq!(report.sufficient, sufficient.n_samples);
    for (i, trial) in trials.iter().enumerate() {
        let half = trials[..i].iter().rfind(|half| 2 * half.n_samples <= trial.n_samples);
        assert_eq!(half.is_some_and(|half| is_enough(half, trial)), i + 1 == trials.len());
    }
    assert!(trials.windows(2).all(|pair| pair[0].n_samples < pair[1].n_samples));
    assert!(trials.windows(2).all(|pair| pair[1].n_samples as f64 <= 1.2 * pair[0].n_samples as f64 + 1.0));
    assert!((5..=16).contains(&report.rows), "{}", report.rows);
}

#[test]
fn a_search_ends_for_other_reasons_too() {
    // Points in space are exact from the first samples, of which there are eight.
    for (p, power, limit, expected) in [
        (60, 0.8, 10, (3, SampleStop::Limit)),
        (7, 0.8, 640, (1, SampleStop::AllPoints)),
        (8, 0.8, 640, (1, SampleStop::AllPoints)),
        (80, 1.0, 640, (1, SampleStop::Settled)),
    ] {
        let report = search(p, power, 1.0, limit, 1).2;
        assert_eq!((report.tried.len(), report.stop), expected);
    }
}

#[test]
fn the_unit_of_length_changes_nothing() {
    let [base, other] = [1.0, 1024.0].map(|unit| search(150, 0.8, unit, 100, 5).2);
    assert_eq!(base.tried.len(), other.tried.len());
    for (a, b) in base.tried.iter().zip(&other.tried) {
        assert!((a.normalized / b.normalized - 1.0).abs() < 1e-9);
        assert!((a.stress * 1024.0 * 1024.0 / b.stress - 1.0).abs() < 1e-9);
    }
}
