//! Choice of landmarks.

use linalg::{LandmarkDistances, Matrix};
use mesh::VertexId;

use crate::{DistanceSolver, GeodesicError};

/// The first sample of [`farthest_point_sampling`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FirstSample {
    /// The vertex farthest from vertex 0: a tip of the surface, the same in every run.
    #[default]
    Farthest,
    /// This vertex.
    Vertex(VertexId),
}

/// Farthest point sampling: `n` landmarks, each the vertex farthest from those before it, and the
/// distances from each to all vertices (Procedure 1 of the paper).
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `r_i` | `landmarks()` of the result | n | the samples |
/// | `F` | `matrix()` of the result | p x n | distances |
///
/// * Ties go to the lowest vertex, so the result depends on the first sample alone.
/// * Covers the surface at most twice as coarsely as the best choice of `n` vertices
///   (Hochbaum and Shmoys 1985).
/// * Stops early, with fewer than `n` landmarks, when every vertex coincides with one.
///
/// Cost: `n` runs of the solver.
///
/// # Errors
/// [`GeodesicError::Disconnected`] when a vertex cannot be reached, so that no infinite distance
/// ever gets into a matrix; [`GeodesicError::NoSuchVertex`]; [`GeodesicError::NoSamples`].
pub fn farthest_point_sampling(
    solver: &dyn DistanceSolver,
    n: usize,
    first: FirstSample,
) -> Result<LandmarkDistances, GeodesicError> {
    let p = solver.n_vertices();
    if n == 0 {
        return Err(GeodesicError::NoSamples);
    }
    let start = match first {
        FirstSample::Vertex(vertex) => vertex,
        FirstSample::Farthest => VertexId(0),
    };
    if start.index() >= p {
        return Err(GeodesicError::NoSuchVertex { vertex: start, n_vertices: p });
    }
    let mut column = reached(solver, start)?;
    let mut landmarks = vec![start.index()];
    if first == FirstSample::Farthest {
        landmarks[0] = farthest(&column);
        column = reached(solver, VertexId::from(landmarks[0]))?;
    }
    let mut nearest = column.clone();
    let mut values = column;
    while landmarks.len() < n.min(p) {
        let next = farthest(&nearest);
        if nearest[next] == 0.0 {
            break;
        }
        let column = reached(solver, VertexId::from(next))?;
        nearest.iter_mut().zip(&column).for_each(|(near, d)| *near = near.min(*d));
        values.extend_from_slice(&column);
        landmarks.push(next);
    }
    let columns = Matrix::from_vec(p, landmarks.len(), values);
    Ok(LandmarkDistances::new(landmarks, columns)
        .unwrap_or_else(|fault| unreachable!("every column was checked: {fault}")))
}

/// The distances from `source`, all finite.
fn reached(solver: &dyn DistanceSolver, source: VertexId) -> Result<Vec<f64>, GeodesicError> {
    let column = solver.distances(source);
    match column.iter().filter(|d| !d.is_finite()).count() {
        0 => Ok(column),
        unreached => {
            Err(GeodesicError::Disconnected { unreached, n_vertices: column.len(), source_vertex: source })
        }
    }
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
