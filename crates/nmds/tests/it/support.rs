//! Points with known coordinates, for the tests of this crate.

use canonform_nmds::{Embedding, LandmarkPairs};
use linalg::{DistanceMatrix, LandmarkDistances, Matrix};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// Points drawn uniformly from a box with sides of different lengths, so that no two axes are equal.
pub(crate) struct Cloud {
    points: Vec<Vec<f64>>,
}

impl Cloud {
    pub(crate) fn new(p: usize, dim: usize, seed: u64) -> Self {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let mut uniform = || (rng.next_u64() >> 11) as f64 / (1u64 << 53) as f64;
        let points = (0..p).map(|_| (0..dim).map(|j| uniform() * 10.0 / (j + 1) as f64).collect()).collect();
        Self { points }
    }

    pub(crate) fn distance(&self, i: usize, j: usize) -> f64 {
        self.points[i].iter().zip(&self.points[j]).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt()
    }

    pub(crate) fn len(&self) -> usize {
        self.points.len()
    }
}

/// Exact distances from the first `n` points.
pub(crate) fn landmark_distances(cloud: &Cloud, n: usize) -> LandmarkDistances {
    let columns = Matrix::from_fn(cloud.len(), n, |i, j| cloud.distance(i, j));
    LandmarkDistances::new((0..n).collect(), columns).unwrap()
}

/// The largest difference between a distance in the cloud and in the embedding; zero if and only if they are congruent.
/// Of a large cloud, each point is compared with some of the others.
pub(crate) fn procrustes_free_gap(cloud: &Cloud, embedding: &Embedding) -> f64 {
    let mut gap = 0.0f64;
    for i in 0..cloud.len() {
        for j in (0..i).step_by(cloud.len().div_ceil(1000)) {
            let embedded = (embedding.coords.row(i) - embedding.coords.row(j)).norm();
            gap = gap.max((embedded - cloud.distance(i, j)).abs());
        }
    }
    gap
}

/// Distances between all rows.
pub(crate) fn pairwise(coords: &Matrix) -> Matrix {
    let p = coords.nrows();
    Matrix::from_fn(p, p, |i, j| (coords.row(i) - coords.row(j)).norm())
}

/// Distances between points on a circle along its arc: far from Euclidean.
pub(crate) fn circle(p: usize) -> DistanceMatrix {
    DistanceMatrix::from_pairs(p, |i, j| (j - i).min(p - (j - i)) as f64).unwrap()
}

/// The same distances in another unit of length.
pub(crate) fn scaled(distances: &LandmarkDistances, scale: f64) -> LandmarkDistances {
    LandmarkDistances::new(distances.landmarks().to_vec(), distances.to_matrix().unwrap() * scale).unwrap()
}

/// Gives `work` the pairs of all points, which count alike.
pub(crate) fn all_pairs<T>(distances: &DistanceMatrix, work: impl FnOnce(&LandmarkPairs<'_>) -> T) -> T {
    let landmarks: Vec<usize> = (0..distances.n_points()).collect();
    let masses = vec![1.0; landmarks.len()];
    work(&LandmarkPairs { landmarks: &landmarks, rows: distances, masses: &masses, power: 0.0 })
}
