//! The landmarks taken so far and the distances from them.

use std::borrow::Cow;

use linalg::{ColumnStore, LandmarkDistances};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;
use surface::VertexId;

use super::sampler::FirstSample;
use crate::error::GeodesicError;
use crate::solver::DistanceSolver;

/// Most columns that are measured at once: some solvers take many sources at once faster than one by one.
const BATCH: usize = 64;

/// Landmarks with the distances from them, all finite.
#[derive(Debug)]
pub(super) struct Columns<'a> {
    pub(super) solver: &'a dyn DistanceSolver,
    pub(super) landmarks: Vec<usize>,
    pub(super) store: ColumnStore,
}

impl<'a> Columns<'a> {
    pub(super) fn new(solver: &'a dyn DistanceSolver) -> Self {
        Self { solver, landmarks: Vec::new(), store: ColumnStore::in_memory(solver.n_vertices()) }
    }

    pub(super) fn len(&self) -> usize {
        self.landmarks.len()
    }

    /// Moves the distances into another, empty store.
    pub(super) fn move_to(&mut self, mut store: ColumnStore) -> Result<(), GeodesicError> {
        for index in 0..self.len() {
            store.push(&self.store.column(index)?)?;
        }
        self.store = store;
        Ok(())
    }

    /// Adds landmarks and finds the distances from them, in parallel.
    pub(super) fn add(&mut self, landmarks: &[usize]) -> Result<(), GeodesicError> {
        // Columns in a file are few in memory.
        let batch = if self.store.is_in_file() { rayon::current_num_threads() } else { BATCH };
        let n_vertices = self.solver.n_vertices();
        for landmarks in landmarks.chunks(batch) {
            let sources: Vec<VertexId> = landmarks.iter().map(|&landmark| VertexId::from(landmark)).collect();
            let columns = self.solver.distance_columns(&sources)?;
            let slots = self.store.grow(sources.len(), &self.solver.budget())?;
            for ((source, column), slot) in sources.iter().zip(columns.column_iter()).zip(slots) {
                let unreached = column.iter().filter(|d| !d.is_finite()).count();
                if unreached > 0 {
                    self.store.truncate(self.landmarks.len());
                    return Err(GeodesicError::Disconnected {
                        unreached,
                        n_vertices,
                        source_vertex: *source,
                    });
                }
                slot.fill(|place| {
                    place.copy_from_slice(column.as_slice());
                    Ok(())
                })?;
            }
            self.landmarks.extend_from_slice(landmarks);
        }
        Ok(())
    }

    pub(super) fn last(&self) -> Result<Cow<'_, [f64]>, GeodesicError> {
        Ok(self.store.column(self.len() - 1)?)
    }

    /// The distances from the first `n` landmarks, or from all if there are fewer.
    pub(super) fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        let n = n.min(self.len());
        landmark_distances(self.landmarks[..n].to_vec(), self.store.first(n))
    }

    /// The same, without a copy.
    pub(super) fn into_distances(mut self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        self.landmarks.truncate(n);
        self.store.truncate(n);
        landmark_distances(self.landmarks, self.store)
    }
}

fn landmark_distances(landmarks: Vec<usize>, store: ColumnStore) -> Result<LandmarkDistances, GeodesicError> {
    match landmarks.is_empty() {
        true => Err(GeodesicError::NoSamples),
        false => Ok(LandmarkDistances::of_columns(landmarks, store)?),
    }
}

/// The first of `n_vertices` vertices: the given one, or a random one.
pub(super) fn first_vertex(
    first: FirstSample,
    n_vertices: usize,
    rng: &mut ChaCha8Rng,
) -> Result<usize, GeodesicError> {
    match first {
        _ if n_vertices == 0 => Err(GeodesicError::NoSamples),
        FirstSample::Vertex(vertex) if vertex.index() >= n_vertices => {
            Err(GeodesicError::NoSuchVertex { vertex, n_vertices })
        }
        FirstSample::Vertex(vertex) => Ok(vertex.index()),
        FirstSample::Farthest => Ok(below(n_vertices, rng)),
    }
}

/// A random number below `limit`, which must be positive; uniform to one in 2^64.
pub(super) fn below(limit: usize, rng: &mut ChaCha8Rng) -> usize {
    (rng.next_u64() % limit as u64) as usize
}
