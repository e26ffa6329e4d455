//! SMACOF of the distances from landmarks.

use base::Observer;
use linalg::{LandmarkDistances, Matrix, sq_distance};
use rayon::prelude::*;

use crate::squares::{check_dim, check_extent, check_points};
use crate::{Embedding, NmdsError};

/// Options of [`landmark_smacof`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LandmarkSmacofOptions {
    /// Weights of pairs are this power of the inverse distance: 0 weighs all alike, 1 is Sammon's mapping. Default: 0.
    pub power: f64,
    /// Number of steps, each of all points and all landmarks. Default: 20.
    pub steps: usize,
}

impl Default for LandmarkSmacofOptions {
    fn default() -> Self {
        Self { power: 0.0, steps: 20 }
    }
}

/// SMACOF without the distances of all pairs: starts from the coordinates `start` (p x k) and lowers the stress
/// `sum m_i w_is (d_is - |x_i - x_s|)^2` over all points `i` and landmarks `s`, with the masses `m` of the points and the
/// weights `w = d^-power`.
///
/// Each step moves every other point to the minimum of a majorant of its own share of the stress,
/// `x_i <- sum_s w_is (x_s + d_is u_is) / sum_s w_is` with `u_is` the unit vector from `x_s` to `x_i`, and then every landmark
/// in turn by all points. The stress never increases.
///
/// * Fits distances, whereas Nystrom scaling fits their squares, so that small features count more.
/// * Nearly as good as [`smacof`](crate::smacof) of all pairs if the landmarks are spread evenly.
/// * The result is centred and rotated to its principal axes; `eigenvalues` are the k of `X' X`.
/// * Cost: `O(p n k)` per step and `O(p n)` memory. Does not depend on the number of threads.
///
/// After de Leeuw 1977 and Sammon 1969 (`deleeuw1977`, `sammon1969` in `REFERENCES.bib`).
///
/// # Errors
/// [`NmdsError::PointMismatch`] unless there is a row and a mass for each point, [`NmdsError::BadDimension`],
/// [`NmdsError::NoExtent`], [`NmdsError::Linalg`]; [`NmdsError::Exceeded`].
pub fn landmark_smacof(
    start: &Matrix,
    distances: &LandmarkDistances,
    masses: &[f64],
    options: &LandmarkSmacofOptions,
    observer: &dyn Observer,
) -> Result<Embedding, NmdsError> {
    let (p, dim) = start.shape();
    check_points(p, distances.n_points())?;
    check_points(masses.len(), p)?;
    check_dim(dim, p)?;
    let unit = check_extent(distances.max(), p)?;
    let mut is_landmark = vec![false; p];
    distances.landmarks().iter().for_each(|&landmark| is_landmark[landmark] = true);
    let pairs = LandmarkPairs {
        // The distances of a point from all landmarks are a column.
        distances: (distances.to_matrix()? / unit).transpose(),
        landmarks: distances.landmarks(),
        is_landmark,
        masses,
        power: options.power,
    };
    let mut points = (start / unit).transpose();
    for _ in 0..options.steps {
        observer.budget().check()?;
        pairs.step(&mut points);
    }
    Embedding::along_principal_axes(points.transpose(), unit, dim)
}

/// What is to be fitted; lengths are in units of the largest distance.
struct LandmarkPairs<'a> {
    distances: Matrix,
    landmarks: &'a [usize],
    is_landmark: Vec<bool>,
    masses: &'a [f64],
    power: f64,
}

impl LandmarkPairs<'_> {
    fn weight(&self, distance: f64) -> f64 {
        match self.power {
            0.0 => 1.0,
            1.0 => 1.0 / distance,
            power => distance.powf(-power),
        }
    }

    /// Moves all points, the columns of `points`.
    fn step(&self, points: &mut Matrix) {
        let (dim, p) = points.shape();
        let landmarks = points.select_columns(self.landmarks);
        points.as_mut_slice().par_chunks_mut(dim).enumerate().for_each(|(i, point)| {
            // Landmarks wait for their turn.
            if !self.is_landmark[i] {
                let distances = self.distances.column(i);
                let others = landmarks.as_slice().chunks_exact(dim).zip(distances.iter());
                pulled(point, others.map(|(x, d)| (x, *d, self.weight(*d))));
            }
        });
        for (s, &landmark) in self.landmarks.iter().enumerate() {
            let mut point = points.column(landmark).into_owned();
            let other = |(i, x)| {
                let d = self.distances[(s, i)];
                // A pair of landmarks belongs to both of them.
                let twice = if self.is_landmark[i] { self.masses[landmark] } else { 0.0 };
                (x, d, (self.masses[i] + twice) * self.weight(d))
            };
            let others = points.as_slice().chunks_exact(dim).enumerate().take(p).map(other);
            pulled(point.as_mut_slice(), others);
            points.set_column(landmark, &point);
        }
    }
}

/// Moves a point by other points, with their distances and weights. A point that coincides with another is not moved by it, and a
/// distance of zero has no weight.
fn pulled<'a>(point: &mut [f64], others: impl Iterator<Item = (&'a [f64], f64, f64)>) {
    let mut sums = vec![0.0; point.len()];
    let mut total = 0.0;
    for (other, distance, weight) in others.filter(|(_, distance, _)| *distance > 0.0) {
        let sq = sq_distance(point, other);
        let pull = if sq > 0.0 { weight * distance / sq.sqrt() } else { 0.0 };
        for (sum, (a, b)) in sums.iter_mut().zip(point.iter().zip(other)) {
            *sum += weight * b + pull * (a - b);
        }
        total += weight;
    }
    if total > 0.0 {
        point.iter_mut().zip(sums).for_each(|(x, sum)| *x = sum / total);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tests::support::{Cloud, landmark_distances, procrustes_free_gap, scaled};
    use crate::{NystromOptions, nystrom};

    const N: usize = 30;

    /// Distances of a cloud raised to a power, and their Nystrom scaling.
    fn problem(power: f64) -> (LandmarkDistances, Matrix) {
        let cloud = Cloud::new(300, 4, 51);
        let columns = Matrix::from_fn(300, N, |i, j| cloud.distance(i, j).powf(power));
        let distances = LandmarkDistances::new((0..N).collect(), columns).unwrap();
        let start = nystrom(&distances, &NystromOptions::default()).unwrap().coords;
        (distances, start)
    }

    fn masses(p: usize) -> Vec<f64> {
        (0..p).map(|i| 1.0 + (i % 5) as f64).collect()
    }

    #[test]
    fn euclidean_distances_stay_exact() {
        let cloud = Cloud::new(200, 3, 7);
        let distances = landmark_distances(&cloud, 20);
        let start = nystrom(&distances, &NystromOptions::default()).unwrap().coords;
        for power in [0.0, 1.0] {
            let options = LandmarkSmacofOptions { power, ..Default::default() };
            let found = landmark_smacof(&start, &distances, &masses(200), &options, &()).unwrap();
            assert!(procrustes_free_gap(&cloud, &found) < 1e-6);
        }
    }

    #[test]
    fn the_stress_never_increases() {
        let (distances, start) = problem(0.7);
        let masses = masses(300);
        let columns = distances.to_matrix().unwrap();
        for power in [0.0, 1.0] {
            let mut last = f64::INFINITY;
            for steps in [0, 1, 2, 5, 20] {
                let options = LandmarkSmacofOptions { power, steps };
                let found = landmark_smacof(&start, &distances, &masses, &options, &()).unwrap();
                let term = |i: usize, s: usize| {
                    let d = columns[(i, s)];
                    let length = (found.coords.row(i) - found.coords.row(s)).norm();
                    if d > 0.0 { masses[i] * d.powf(-power) * (d - length).powi(2) } else { 0.0 }
                };
                let stress: f64 = (0..300).map(|i| (0..N).map(|s| term(i, s)).sum::<f64>()).sum();
                assert!(stress < last, "{power}, {steps}: {stress} after {last}");
                last = stress;
            }
        }
    }

    #[test]
    fn the_unit_of_length_does_not_matter() {
        let (distances, start) = problem(0.7);
        let options = LandmarkSmacofOptions { power: 1.0, ..Default::default() };
        let one = landmark_smacof(&start, &distances, &masses(300), &options, &()).unwrap();
        let large = landmark_smacof(&(&start * 8.0), &scaled(&distances, 8.0), &masses(300), &options, &());
        assert!((large.unwrap().coords / 8.0 - one.coords).amax() < 1e-9);
    }

    #[test]
    fn mismatched_arguments_are_rejected() {
        let (distances, start) = problem(1.0);
        let fault = landmark_smacof(&start, &distances, &masses(299), &Default::default(), &()).unwrap_err();
        assert_eq!(fault, NmdsError::PointMismatch { given: 299, n_points: 300 });
    }
}
