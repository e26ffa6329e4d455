//! What every way of measuring distances has in common.

use std::sync::{Mutex, PoisonError};

use linalg::{DistanceMatrix, LinalgError, Matrix};
use rayon::prelude::*;
use surface::VertexId;

use crate::Source;

/// Distances from a vertex to all vertices of one surface.
///
/// A solver holds what can be computed once per surface; a call may come from any thread.
pub trait DistanceSolver: Sync + std::fmt::Debug {
    /// Number of vertices of the surface.
    fn n_vertices(&self) -> usize;

    /// Writes the distance from the nearest of `sources` to every vertex, in mesh units; infinite
    /// where there is no way and beyond `max_distance`.
    ///
    /// # Panics
    /// When `out` does not have one entry per vertex or a source belongs to another surface.
    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]);

    /// Writes the distance from the vertex `source` to every vertex, in mesh units; infinite where
    /// there is no way.
    ///
    /// # Panics
    /// When `out` does not have one entry per vertex or `source` is out of range.
    fn distances_into(&self, source: VertexId, out: &mut [f64]) {
        self.solve_into(&[Source::vertex(source)], f64::INFINITY, out);
    }

    /// The distance from `source` to every vertex, in mesh units; infinite where there is no way.
    ///
    /// # Panics
    /// When `source` is out of range.
    fn distances(&self, source: VertexId) -> Vec<f64> {
        let mut out = vec![f64::INFINITY; self.n_vertices()];
        self.distances_into(source, &mut out);
        out
    }

    /// The solver that stops where another source is nearer, if there is one.
    fn pruned(&self) -> Option<&dyn PrunedSolver> {
        None
    }

    /// One column of distances per source, computed in parallel; the result does not depend on the
    /// number of threads.
    fn distance_columns(&self, sources: &[VertexId]) -> Matrix {
        let p = self.n_vertices();
        let mut columns = Matrix::zeros(p, sources.len());
        if p > 0 {
            columns
                .as_mut_slice()
                .par_chunks_mut(p)
                .zip(sources)
                .for_each(|(column, source)| self.distances_into(*source, column));
        }
        columns
    }

    /// The distances between all pairs of vertices, each the mean of there and back, `n_vertices^2` numbers.
    ///
    /// # Errors
    /// When a vertex cannot be reached from another one.
    fn distance_matrix(&self) -> Result<DistanceMatrix, LinalgError> {
        let all: Vec<VertexId> = (0..self.n_vertices()).map(VertexId::from).collect();
        DistanceMatrix::from_rows(all.len(), self.distance_columns(&all).data.into())
    }
}

/// A solver whose fronts can stop where another source is nearer: the cost is that of the part of the
/// surface that is nearest to the new source.
pub trait PrunedSolver: Sync + std::fmt::Debug {
    /// Lowers `nearest`, the distance from every vertex to the nearest of some sources, to the distance
    /// from `source` wherever that is smaller.
    ///
    /// # Panics
    /// When `nearest` does not have one entry per vertex or `source` is out of range.
    fn lower(&self, source: VertexId, nearest: &mut [f64]);
}

/// The distance, or infinity beyond the limit: the front leaves tentative values behind it.
#[inline]
pub(crate) fn within(distance: f64, max_distance: f64) -> f64 {
    if distance <= max_distance { distance } else { f64::INFINITY }
}

/// Scratch memory that calls borrow and give back, so that none is allocated after the first calls.
#[derive(Debug, Default)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Runs `work` on a piece of scratch memory in whatever state the previous user left it.
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = lock().pop().unwrap_or_default();
        let result = work(&mut scratch);
        lock().push(scratch);
        result
    }
}
