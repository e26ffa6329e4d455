use canonform_nmds::*;
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};

use crate::support::Cloud;

/// All distances of a problem, and landmarks in the order in which they are taken.
struct Problem {
    distances: DistanceMatrix,
    order: Vec<usize>,
    options: NystromOptions,
}

impl Problem {
    /// Distances that are not Euclidean, raised to a power below 1.
    fn new(p: usize, power: f64, dim: usize) -> Self {
        let cloud = Cloud::new(p, 3, 11);
        let distances = DistanceMatrix::from_pairs(p, |i, j| cloud.distance(i, j).powf(power)).unwrap();
        let order = (0..p).map(|i| (i * 37) % p).collect();
        Self { distances, order, options: NystromOptions { dim, ..NystromOptions::default() } }
    }

    fn columns(&self, of: &[usize]) -> Matrix {
        Matrix::from_fn(self.distances.n_points(), of.len(), |i, j| self.distances.get(i, of[j]))
    }

    fn landmarks(&self, n: usize) -> LandmarkDistances {
        let landmarks = self.order[..n.min(self.order.len())].to_vec();
        let columns = self.columns(&landmarks);
        LandmarkDistances::new(landmarks, columns).unwrap()
    }

    fn search(&self, limit: usize, seed: u64) -> Found {
        let embed = |distances: &LandmarkDistances| nystrom(distances, &self.options);
        let search = SampleSearch { first: self.options.first_samples(), limit, seed, embed: &embed };
        search.run::<NmdsError>(|n| Ok(self.landmarks(n)), |rows| Ok(self.columns(rows))).unwrap()
    }
}

type Found = (Embedding, LandmarkDistances, SamplesReport);

#[test]
fn a_search_ends_when_twice_the_samples_do_not_help() {
    let (_, distances, report) = Problem::new(240, 0.8, 3).search(200, 0);
    assert_eq!(report.stop, SampleStop::Settled);
    let (trials, half) = (report.tried, report.sufficient);
    assert_eq!(trials.last().unwrap().n_samples, distances.n_landmarks());
    assert!(2 * half <= distances.n_landmarks(), "{half} of {}", distances.n_landmarks());
    assert!(trials.windows(2).all(|pair| pair[0].n_samples < pair[1].n_samples));
    assert!(trials.windows(2).all(|pair| pair[1].n_samples as f64 <= 1.2 * pair[0].n_samples as f64 + 1.0));
    assert!((5..=16).contains(&report.rows), "{}", report.rows);
}

#[test]
fn a_search_ends_for_other_reasons_too() {
    let stop = |p, power, limit| Problem::new(p, power, 3).search(limit, 1).2.stop;
    assert_eq!(stop(60, 0.8, 10), SampleStop::Limit);
    assert_eq!(stop(7, 0.8, 640), SampleStop::AllPoints);
    // Points in space are exact from the first samples.
    let (_, _, report) = Problem::new(80, 1.0, 3).search(640, 0);
    assert_eq!((report.tried.len(), report.stop), (1, SampleStop::Settled));
}

#[test]
fn the_unit_of_length_changes_nothing() {
    let problem = Problem::new(150, 0.8, 3);
    let base = problem.search(100, 5).2;
    let scaled = DistanceMatrix::from_pairs(150, |i, j| 1024.0 * problem.distances.get(i, j)).unwrap();
    let other = Problem { distances: scaled, ..problem }.search(100, 5).2;
    assert_eq!(base.tried.len(), other.tried.len());
    for (a, b) in base.tried.iter().zip(&other.tried) {
        assert!((a.normalized / b.normalized - 1.0).abs() < 1e-9);
        assert!((a.stress * 1024.0 * 1024.0 / b.stress - 1.0).abs() < 1e-9);
    }
}
