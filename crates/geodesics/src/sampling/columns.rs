//! The landmarks taken so far and the distances from them.

use linalg::{LandmarkDistances, Matrix};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;
use surface::VertexId;

use super::sampler::FirstSample;
use crate::error::GeodesicError;
use crate::solver::DistanceSolver;

/// Landmarks with the distances from them, all finite.
#[derive(Debug)]
pub(super) struct Columns<'a> {
    pub(super) solver: &'a dyn DistanceSolver,
    pub(super) landmarks: Vec<usize>,
    pub(super) values: Vec<f64>,
}

impl<'a> Columns<'a> {
    pub(super) fn new(solver: &'a dyn DistanceSolver) -> Self {
        Self { solver, landmarks: Vec::new(), values: Vec::new() }
    }

    pub(super) fn len(&self) -> usize {
        self.landmarks.len()
    }

    /// Adds landmarks and finds the distances from them, in parallel.
    pub(super) fn add(&mut self, landmarks: &[usize]) -> Result<(), GeodesicError> {
        let sources: Vec<VertexId> = landmarks.iter().map(|&landmark| VertexId::from(landmark)).collect();
        let columns = self.solver.distance_columns(&sources)?;
        for (source, column) in sources.iter().zip(columns.column_iter()) {
            let unreached = column.iter().filter(|d| !d.is_finite()).count();
            if unreached > 0 {
                let n_vertices = self.solver.n_vertices();
                return Err(GeodesicError::Disconnected { unreached, n_vertices, source_vertex: *source });
            }
        }
        self.landmarks.extend_from_slice(landmarks);
        self.values.extend_from_slice(columns.as_slice());
        Ok(())
    }

    pub(super) fn last(&self) -> &[f64] {
        &self.values[self.values.len() - self.solver.n_vertices()..]
    }

    /// The distances from the first `n` landmarks, or from all if there are fewer.
    pub(super) fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        let (p, n) = (self.solver.n_vertices(), n.min(self.len()));
        if n == 0 {
            return Err(GeodesicError::NoSamples);
        }
        let columns = Matrix::from_column_slice(p, n, &self.values[..p * n]);
        Ok(LandmarkDistances::new(self.landmarks[..n].to_vec(), columns)
            .unwrap_or_else(|fault| unreachable!("every column was checked: {fault}")))
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
