//! Landmarks chosen by how much their squared distances to each other vary.

use linalg::LandmarkDistances;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::Sampler;
use super::columns::{Columns, below, first_vertex};
use crate::{DistanceSolver, FirstSample, GeodesicError};

/// Which vertex [`VarianceSampler`] takes next.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
pub enum Variance {
    /// The one whose squared distances to the landmarks vary least, as Yu et al. do.
    #[default]
    #[serde(rename = "min-variance")]
    Least,
    /// The one whose squared distances vary most: the opposite rule, to hold the first against.
    #[serde(rename = "max-variance")]
    Greatest,
}

/// Incremental sampling by variance ("Min-Var"): two landmarks are drawn, then each is the vertex `j` with the
/// least (or greatest) variance of `E_ij` over the landmarks `i` so far, `E` being squared distances.
///
/// * Equal squared distances to all landmarks mean a central vertex, so the least variance leaves out the tips of
///   a surface, and neighbours of a landmark soon follow it: the samples are close together, and the stress
///   is far above that of farthest point sampling.
/// * Ties go to the lowest vertex. The seed decides what is drawn, whatever the number of threads.
///
/// Cost: one run of the solver per landmark, and `O(p)`: means and variances are updated, not recomputed
/// (Welford 1962).
///
/// After Yu, Zhao, Zhang and Yang 2012 (`yu2012` in `REFERENCES.bib`).
#[derive(Debug)]
pub struct VarianceSampler<'a> {
    columns: Columns<'a>,
    variance: Variance,
    /// The second landmark.
    second: Option<usize>,
    /// Of every vertex: the mean of its squared distances to the landmarks, and the sum of the squares
    /// of what they differ from it.
    moments: Vec<[f64; 2]>,
    is_landmark: Vec<bool>,
}

impl<'a> VarianceSampler<'a> {
    /// Draws the first two landmarks; the first may be chosen.
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
        // One of the others: those from the first on move up by one.
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
        for ([mean, spread], d) in self.moments.iter_mut().zip(self.columns.last()) {
            let square = d * d;
            let off = square - *mean;
            *mean += off / count;
            *spread += off * (square - *mean);
        }
        Ok(())
    }

    /// The vertex to take next; none when all are landmarks.
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
}

#[cfg(test)]
mod tests {
    use mesh::shapes::{grid, icosphere};
    use surface::VertexId;

    use super::*;
    use crate::Dijkstra;

    #[test]
    fn every_landmark_has_the_extreme_variance_of_the_definition() {
        let solver = Dijkstra::new(&icosphere(2).intrinsic());
        for (variance, sign) in [(Variance::Least, 1.0), (Variance::Greatest, -1.0)] {
            let mut sampler = VarianceSampler::new(&solver, FirstSample::default(), 5, variance).unwrap();
            sampler.extend_to(12).unwrap();
            let distances = sampler.distances(12).unwrap();
            for n in 2..12 {
                let spread = |v: usize| {
                    let squares: Vec<f64> = (0..n).map(|i| distances.column(i)[v].powi(2)).collect();
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
    fn the_least_variance_is_central_and_the_greatest_is_not() {
        // A long strip: what is equally far from both ends lies in the middle.
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
