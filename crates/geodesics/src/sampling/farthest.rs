//! Farthest point sampling.

use std::sync::OnceLock;

use budget::Exceeded;
use linalg::LandmarkDistances;
use surface::VertexId;

use super::columns::Columns;
use super::sampler::{FirstSample, Sampler};
use crate::error::GeodesicError;
use crate::solver::{DistanceSolver, PrunedSolver};

/// Farthest point sampling: each landmark is the vertex farthest from those before it (Procedure 1 of the paper).
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `r_i` | `landmarks()` of the result | n | the samples |
/// | `F` | `matrix()` of the result | p x n | distances |
///
/// * Ties go to the lowest vertex, so the result depends only on the first sample.
/// * It covers the surface at most twice as coarsely as the best `n` vertices (Hochbaum and Shmoys 1985,
///   `hochbaum1985`).
/// * It ends early, with fewer landmarks than requested, if every vertex coincides with one.
///
/// Cost: one run of the solver per landmark. On several threads, the runs are parallel if the solver can prune: about
/// `1/2 + ... + 1/n` additional runs choose the landmarks in advance. The result is the same.
///
/// ```
/// use canonform_geodesics::{Dijkstra, FarthestPointSampler, FirstSample, Sampler};
/// use mesh::shapes;
///
/// // A strip: first its ends, then its middle.
/// let solver = Dijkstra::new(&shapes::grid(9, 2, 1.0).intrinsic());
/// let mut sampler = FarthestPointSampler::new(&solver, FirstSample::Farthest)?;
/// sampler.extend_to(3)?;
/// let columns = sampler.distances(3)?;
/// assert!(columns.landmarks()[2] % 9 == 4);
/// # Ok::<(), canonform_geodesics::GeodesicError>(())
/// ```
#[derive(Debug)]
pub struct FarthestPointSampler<'a> {
    columns: Columns<'a>,
    /// Distance of every vertex to its nearest landmark.
    nearest: Vec<f64>,
}

impl<'a> FarthestPointSampler<'a> {
    /// Takes the first sample.
    ///
    /// # Errors
    /// [`GeodesicError::Disconnected`] if a vertex cannot be reached; [`GeodesicError::NoSuchVertex`].
    pub fn new(solver: &'a dyn DistanceSolver, first: FirstSample) -> Result<Self, GeodesicError> {
        let n_vertices = solver.n_vertices();
        let start = match first {
            FirstSample::Vertex(vertex) => vertex,
            FirstSample::Farthest => VertexId(0),
        };
        if start.index() >= n_vertices {
            return Err(GeodesicError::NoSuchVertex { vertex: start, n_vertices });
        }
        let mut columns = Columns::new(solver);
        columns.add(&[start.index()])?;
        if first == FirstSample::Farthest {
            let landmark = farthest(columns.last());
            columns = Columns::new(solver);
            columns.add(&[landmark])?;
        }
        Ok(Self { nearest: columns.last().to_vec(), columns })
    }

    /// Takes each landmark after the distances from those before.
    fn extend_fully(&mut self, n: usize) -> Result<(), GeodesicError> {
        while self.columns.len() < n {
            let next = farthest(&self.nearest);
            if self.nearest[next] == 0.0 {
                break;
            }
            self.columns.add(&[next])?;
            lower(&mut self.nearest, self.columns.last());
        }
        Ok(())
    }

    /// Chooses landmarks with pruned fronts, which stop half-way to earlier landmarks, while other threads compute
    /// the distances from those chosen. The first landmark reaches every vertex, so all do.
    ///
    /// Distances may be too long where a pruned front stopped. So the choices are checked once all distances are
    /// known, and kept up to the first that is not the farthest vertex.
    fn extend_pruned(&mut self, pruned: &dyn PrunedSolver, n: usize) -> Result<(), GeodesicError> {
        let Columns { solver, landmarks, values } = &mut self.columns;
        let (p, solver, before) = (self.nearest.len(), *solver, landmarks.len());
        let mut nearest = self.nearest.clone();
        let mut guesses = Vec::new();
        let more = p * n.saturating_sub(before);
        let needed = size_of::<f64>() * (values.len() + more);
        solver.budget().check_memory(needed)?;
        values.try_reserve(more).map_err(|_| Exceeded::Allocation { needed })?;
        values.resize(values.len() + more, 0.0);
        let exceeded = OnceLock::new();
        let note = &|result: Result<(), Exceeded>| {
            if let Err(error) = result {
                exceeded.get_or_init(|| error);
            }
        };
        rayon::scope(|scope| {
            let mut unknown = values[p * before..].chunks_mut(p.max(1)).peekable();
            while let Some(column) = unknown.next() {
                let next = farthest(&nearest);
                if nearest[next] == 0.0 || exceeded.get().is_some() {
                    break;
                }
                guesses.push(next);
                scope.spawn(move |_| note(solver.distances_into(VertexId::from(next), column)));
                if unknown.peek().is_some() {
                    note(pruned.lower(VertexId::from(next), &mut nearest));
                }
            }
        });
        if let Some(exceeded) = exceeded.into_inner() {
            values.truncate(p * before);
            return Err(exceeded.into());
        }
        for (guess, column) in guesses.into_iter().zip(values[p * before..].chunks(p.max(1))) {
            if guess != farthest(&self.nearest) {
                break;
            }
            landmarks.push(guess);
            lower(&mut self.nearest, column);
        }
        values.truncate(p * landmarks.len());
        Ok(())
    }
}

impl Sampler for FarthestPointSampler<'_> {
    fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError> {
        let n = n.min(self.nearest.len());
        if rayon::current_num_threads() > 1
            && let Some(pruned) = self.columns.solver.pruned()
        {
            self.extend_pruned(pruned, n)?;
        }
        self.extend_fully(n)
    }

    fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        self.columns.distances(n)
    }
}

/// The distances from `n` landmarks chosen by [`FarthestPointSampler`].
///
/// # Errors
/// [`GeodesicError::Disconnected`], [`GeodesicError::NoSuchVertex`], [`GeodesicError::NoSamples`].
pub fn farthest_point_sampling(
    solver: &dyn DistanceSolver,
    n: usize,
    first: FirstSample,
) -> Result<LandmarkDistances, GeodesicError> {
    let mut sampler = FarthestPointSampler::new(solver, first)?;
    sampler.extend_to(n)?;
    sampler.distances(n)
}

fn lower(nearest: &mut [f64], column: &[f64]) {
    nearest.iter_mut().zip(column).for_each(|(near, d)| *near = near.min(*d));
}

/// The lowest index of the largest value.
fn farthest(values: &[f64]) -> usize {
    let mut best = 0;
    for (i, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = i;
        }
    }
    best
}
