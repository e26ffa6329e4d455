//! Random landmarks.

use linalg::{ColumnStore, LandmarkDistances};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;

use super::columns::{Columns, below, first_vertex};
use super::sampler::{FirstSample, Sampler};
use crate::error::GeodesicError;
use crate::solver::DistanceSolver;

/// Random sampling, the baseline: every set of n vertices is equally likely. The seed determines it for any number of
/// threads.
///
/// Cost: one run of the solver per landmark, in parallel; `O(p)` to start.
///
/// ```
/// use canonform_geodesics::{Dijkstra, FirstSample, RandomSampler, Sampler};
/// use mesh::shapes;
///
/// let solver = Dijkstra::new(&shapes::icosphere(2).intrinsic());
/// let mut sampler = RandomSampler::new(&solver, FirstSample::default(), 7)?;
/// sampler.extend_to(20)?;
/// assert_eq!(sampler.distances(20)?.n_landmarks(), 20);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct RandomSampler<'a> {
    columns: Columns<'a>,
    order: Vec<usize>,
}

impl<'a> RandomSampler<'a> {
    /// Draws an order of all vertices, beginning with `first`.
    ///
    /// # Errors
    /// [`GeodesicError::NoSuchVertex`], [`GeodesicError::NoSamples`] on an empty surface,
    /// [`GeodesicError::Disconnected`].
    pub fn new(solver: &'a dyn DistanceSolver, first: FirstSample, seed: u64) -> Result<Self, GeodesicError> {
        let mut rng = ChaCha8Rng::seed_from_u64(seed);
        let p = solver.n_vertices();
        let mut order: Vec<usize> = (0..p).collect();
        order.swap(0, first_vertex(first, p, &mut rng)?);
        for i in 1..p {
            order.swap(i, i + below(p - i, &mut rng));
        }
        let mut columns = Columns::new(solver);
        columns.add(&order[..1])?;
        Ok(Self { columns, order })
    }
}

impl Sampler for RandomSampler<'_> {
    fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError> {
        match self.order.get(self.columns.len()..n.min(self.order.len())) {
            Some(next) => self.columns.add(next),
            None => Ok(()),
        }
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
    use mesh::shapes::grid;

    use super::*;
    use crate::breadth_first::BreadthFirst;

    #[test]
    fn all_vertices_are_equally_likely() {
        let solver = BreadthFirst::new(&grid(4, 3, 1.0).intrinsic());
        let p = solver.n_vertices();
        let (runs, n) = (3000, 4);
        let mut taken = vec![0usize; p];
        for seed in 0..runs {
            let mut sampler = RandomSampler::new(&solver, FirstSample::default(), seed).unwrap();
            sampler.extend_to(n).unwrap();
            for landmark in sampler.distances(n).unwrap().landmarks() {
                taken[*landmark] += 1;
            }
        }
        // Each count is binomial; a deviation of five sigmas never happens.
        let share = n as f64 / p as f64;
        let (mean, deviation) = (runs as f64 * share, (runs as f64 * share * (1.0 - share)).sqrt());
        assert!(taken.iter().all(|count| (*count as f64 - mean).abs() < 5.0 * deviation), "{taken:?}");
    }
}
