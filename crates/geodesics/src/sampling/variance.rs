//! Landmarks chosen by the variance of their squared distances.

use linalg::{ColumnStore, LandmarkDistances};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::columns::{Columns, below, first_vertex};
use super::sampler::{FirstSample, Sampler};
use crate::error::GeodesicError;
use crate::solver::DistanceSolver;

/// The rule by which [`VarianceSampler`] takes the next vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Variance {
    /// The vertex whose squared distances to the landmarks vary least, as in Yu et al.
    #[default]
    #[serde(rename = "min-variance")]
    Least,
    /// The vertex whose squared distances vary most: the opposite rule, for comparison.
    #[serde(rename = "max-variance")]
    Greatest,
}

/// Incremental sampling by variance ("Min-Var"; Yu, Zhao, Zhang and Yang 2012, `yu2012`): two landmarks are drawn at
/// random, then each is the vertex `j` with the least (or greatest) variance of the squared distances `E_ij` to the
/// landmarks `i` so far.
///
/// * A vertex with equal squared distances to all landmarks is central. So the least variance avoids the tips of a
///   surface and soon takes neighbours of landmarks: the samples are close together, and the stress is far above that
///   of farthest point sampling.
/// * Ties go to the lowest vertex. The seed determines the result for any number of threads.
///
/// Cost: one run of the solver and `O(p)` per landmark, as means and variances are updated (Welford 1962).
///
/// ```
/// use canonform_geodesics::{Dijkstra, FirstSample, Sampler, Variance, VarianceSampler};
/// use mesh::shapes;
///
/// let solver = Dijkstra::new(&shapes::icosphere(2).intrinsic());
/// let mut sampler = VarianceSampler::new(&solver, FirstSample::default(), 7, Variance::Least)?;
/// sampler.extend_to(20)?;
/// assert_eq!(sampler.distances(20)?.n_landmarks(), 20);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct VarianceSampler<'a> {
    columns: Columns<'a>,
    variance: Variance,
    second: Option<usize>,
    /// For every vertex, the mean of its squared distances to the landmarks and the sum of their squared deviations.
    moments: Vec<[f64; 2]>,
    is_landmark: Vec<bool>,
}

impl<'a> VarianceSampler<'a> {
    /// Starts with the landmark `first` and draws a second one.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`], [`GeodesicError::NoSamples`] on an empty surface,
    /// [`GeodesicError::Disconnected`].
    pub fn new(
        solver: &'a dyn DistanceSolver,
        first: FirstSample,
        seed: u64,
        variance: Variance,
    ) -> Result<Self, GeodesicError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let p = solver.n_vertices();
        let first = first_vertex(first, p, &mut rng)?;
        // Any other vertex: those from the first on move up by one.
        let second = (p > 1).then(|| below(p - 1, &mut rng)).map(|v| if v < first { v } else { v + 1 });
        let mut sampler = Self {
            columns: Columns::new(solver),
            variance,
            second,
            moments: vec![[0.0; 2]; p],
            is_landmark: vec![false; p],
        };
        sampler.add(first)?;
        Ok(sampler)
    }

    fn add(&mut self, landmark: usize) -> Result<(), GeodesicError> {
        self.columns.add(&[landmark])?;
        self.is_landmark[landmark] = true;
        let count = self.columns.len() as f64;
        for ([mean, spread], d) in self.moments.iter_mut().zip(self.columns.last()?.iter()) {
            let square = d * d;
            let off = square - *mean;
            *mean += off / count;
            *spread += off * (square - *mean);
        }
        Ok(())
    }

    /// The next landmark; `None` if all vertices are landmarks.
    fn next(&self) -> Option<usize> {
        if self.columns.len() == 1 {
            return self.second;
        }
        let free = (0..self.moments.len()).filter(|&v| !self.is_landmark[v]);
        let better = |spread: f64, best: f64| match self.variance {
            Variance::Least => spread < best,
            Variance::Greatest => spread > best,
        };
        free.reduce(|best, v| if better(self.moments[v][1], self.moments[best][1]) { v } else { best })
    }
}

impl Sampler for VarianceSampler<'_> {
    fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError> {
        while self.columns.len() < n {
            let Some(next) = self.next() else { break };
            self.add(next)?;
        }
        Ok(())
    }

    fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        self.columns.distances(n)
    }

    fn into_distances(self: Box<Self>, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        self.columns.into_distances(n)
    }

    fn move_to(&mut self, store: ColumnStore) -> Result<(), GeodesicError> {
        self.columns.move_to(store)
    }
}

#[cfg(test)]
mod tests {
    use mesh::shapes::{grid, icosphere};
    use surface::VertexId;

    use super::*;
    use crate::dijkstra::Dijkstra;

    #[test]
    fn every_landmark_has_the_least_or_greatest_variance() {
        let solver = Dijkstra::new(&icosphere(2).intrinsic());
        for (variance, sign) in [(Variance::Least, 1.0), (Variance::Greatest, -1.0)] {
            let mut sampler = VarianceSampler::new(&solver, FirstSample::default(), 5, variance).unwrap();
            sampler.extend_to(12).unwrap();
            let distances = sampler.distances(12).unwrap();
            for n in 2..12 {
                let spread = |v: usize| {
                    let squares: Vec<f64> = (0..n).map(|i| distances.column(i).unwrap()[v].powi(2)).collect();
                    let mean = squares.iter().sum::<f64>() / n as f64;
                    sign * squares.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / n as f64
                };
                let taken = &distances.landmarks()[..n];
                let free = (0..162).filter(|v| !taken.contains(v));
                let best = free.map(spread).fold(f64::INFINITY, f64::min);
                assert!(spread(distances.landmarks()[n]) <= best + 1e-12, "{variance:?} {n}");
            }
        }
    }

    #[test]
    fn the_least_variance_is_in_the_middle_of_a_strip() {
        // The middle of a long strip is equally far from both ends.
        let strip = grid(41, 2, 1.0);
        let middle = |v: usize| (strip.positions[v].x - 20.0).abs() < 1.1;
        let solver = Dijkstra::new(&strip.intrinsic());
        for seed in 0..5 {
            let third = |variance| {
                let first = FirstSample::Vertex(VertexId(0));
                let mut sampler = VarianceSampler::new(&solver, first, seed, variance).unwrap();
                sampler.second = Some(40);
                sampler.extend_to(3).unwrap();
                sampler.distances(3).unwrap().landmarks()[2]
            };
            assert!(middle(third(Variance::Least)));
            assert!(!middle(third(Variance::Greatest)));
        }
    }
}
