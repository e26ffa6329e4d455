//! Farthest point sampling.

use std::sync::OnceLock;

use linalg::{ColumnStore, LandmarkDistances, LinalgError};
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
            let landmark = farthest(&columns.last()?);
            columns = Columns::new(solver);
            columns.add(&[landmark])?;
        }
        let nearest = columns.last()?.into_owned();
        Ok(Self { nearest, columns })
    }

    /// Takes each landmark after the distances from those before.
    fn extend_fully(&mut self, n: usize) -> Result<(), GeodesicError> {
        while self.columns.len() < n {
            let next = farthest(&self.nearest);
            if self.nearest[next] == 0.0 {
                break;
            }
            self.columns.add(&[next])?;
            lower(&mut self.nearest, &self.columns.last()?);
        }
        Ok(())
    }

    /// Chooses landmarks with pruned fronts, which stop half-way to earlier landmarks, while other threads compute
    /// the distances from those chosen. The first landmark reaches every vertex, so all do.
    ///
    /// Distances may be too long where a pruned front stopped. So the choices are checked once all distances are
    /// known, and kept up to the first that is not the farthest vertex.
    fn extend_pruned(&mut self, pruned: &dyn PrunedSolver, n: usize) -> Result<(), GeodesicError> {
        let Columns { solver, landmarks, store } = &mut self.columns;
        let (solver, before) = (*solver, landmarks.len());
        let mut nearest = self.nearest.clone();
        let mut guesses = Vec::new();
        let failed = OnceLock::new();
        let note = &|result: Result<(), LinalgError>| {
            if let Err(error) = result {
                failed.get_or_init(|| error);
            }
        };
        let slots = store.grow(n.saturating_sub(before), &solver.budget())?;
        rayon::scope(|scope| {
            let mut unknown = slots.into_iter().peekable();
            while let Some(slot) = unknown.next() {
                let next = farthest(&nearest);
                if nearest[next] == 0.0 || failed.get().is_some() {
                    break;
                }
                guesses.push(next);
                let source = VertexId::from(next);
                scope.spawn(move |_| note(slot.fill(|column| solver.distances_into(source, column))));
                if unknown.peek().is_some() {
                    note(pruned.lower(source, &mut nearest).map_err(Into::into));
                }
            }
        });
        drop(nearest);
        if let Some(error) = failed.into_inner() {
            store.truncate(before);
            return Err(error.into());
        }
        for (index, guess) in guesses.into_iter().enumerate() {
            if guess != farthest(&self.nearest) {
                break;
            }
            landmarks.push(guess);
            lower(&mut self.nearest, &store.column(before + index)?);
        }
        store.truncate(landmarks.len());
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

    fn into_distances(self: Box<Self>, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        self.columns.into_distances(n)
    }

    fn move_to(&mut self, store: ColumnStore) -> Result<(), GeodesicError> {
        self.columns.move_to(store)
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
pub(super) fn farthest(values: &[f64]) -> usize {
    let mut best = 0;
    for (i, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = i;
        }
    }
    best
}
