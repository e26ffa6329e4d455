//! Choice of landmarks.

use linalg::{LandmarkDistances, Matrix};
use surface::VertexId;

use crate::{DistanceSolver, GeodesicError, PrunedSolver};

/// The first sample of [`farthest_point_sampling`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstSample {
    /// The vertex farthest from vertex 0: a tip of the surface, the same in every run.
    #[default]
    Farthest,
    /// This vertex.
    Vertex(VertexId),
}

/// Farthest point sampling: landmarks, each the vertex farthest from those before it, and the
/// distances from each to all vertices (Procedure 1 of the paper).
///
/// | paper | here | shape | meaning |
/// |---|---|---|---|
/// | `r_i` | `landmarks()` of the result | n | the samples |
/// | `F` | `matrix()` of the result | p x n | distances |
///
/// * Ties go to the lowest vertex, so the result depends on the first sample alone; the first n of
///   2n samples are the n samples.
/// * Covers the surface at most twice as coarsely as the best choice of `n` vertices
///   (Hochbaum and Shmoys 1985).
/// * Ends early, with fewer landmarks than asked for, when every vertex coincides with one.
///
/// Cost: one run of the solver per landmark. On several threads they run side by side where the solver can
/// prune, which takes about `1/2 + ... + 1/n` further runs to choose the landmarks ahead; the result is the
/// same.
#[derive(Debug)]
pub struct FarthestPointSampler<'a> {
    solver: &'a dyn DistanceSolver,
    landmarks: Vec<usize>,
    /// The columns of all landmarks, one after the other.
    columns: Vec<f64>,
    /// Distance of every vertex to its nearest landmark.
    nearest: Vec<f64>,
}

impl<'a> FarthestPointSampler<'a> {
    /// Takes the first sample.
    ///
    /// # Errors
    /// [`GeodesicError::Disconnected`] when a vertex cannot be reached, so that no infinite distance
    /// ever gets into a matrix; [`GeodesicError::NoSuchVertex`].
    pub fn new(solver: &'a dyn DistanceSolver, first: FirstSample) -> Result<Self, GeodesicError> {
        let n_vertices = solver.n_vertices();
        let start = match first {
            FirstSample::Vertex(vertex) => vertex,
            FirstSample::Farthest => VertexId(0),
        };
        if start.index() >= n_vertices {
            return Err(GeodesicError::NoSuchVertex { vertex: start, n_vertices });
        }
        let mut landmark = start.index();
        let mut column = reached(solver, start)?;
        if first == FirstSample::Farthest {
            landmark = farthest(&column);
            column = reached(solver, VertexId::from(landmark))?;
        }
        Ok(Self { solver, landmarks: vec![landmark], nearest: column.clone(), columns: column })
    }

    /// Goes on until there are `n` landmarks, or as many as there are different points.
    ///
    /// # Errors
    /// [`GeodesicError::Disconnected`].
    pub fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError> {
        let n = n.min(self.nearest.len());
        if rayon::current_num_threads() > 1
            && let Some(pruned) = self.solver.pruned()
        {
            self.extend_pruned(pruned, n);
        }
        self.extend_fully(n)
    }

    /// Takes each sample from the distances of the one before.
    fn extend_fully(&mut self, n: usize) -> Result<(), GeodesicError> {
        while self.landmarks.len() < n {
            let next = farthest(&self.nearest);
            if self.nearest[next] == 0.0 {
                break;
            }
            let column = reached(self.solver, VertexId::from(next))?;
            lower(&mut self.nearest, &column);
            self.columns.extend_from_slice(&column);
            self.landmarks.push(next);
        }
        Ok(())
    }

    /// Takes samples by fronts that stop half-way to the samples before, while other threads find the
    /// distances of those that are known. Every vertex was reached from the first sample, so all are.
    ///
    /// Where such a front stopped its distances may be too long. The samples are therefore looked at again once
    /// all distances are known, and kept as far as they are the farthest ones.
    fn extend_pruned(&mut self, pruned: &dyn PrunedSolver, n: usize) {
        let (p, solver, before) = (self.nearest.len(), self.solver, self.landmarks.len());
        let mut nearest = self.nearest.clone();
        let mut guesses = Vec::new();
        self.columns.resize(p * n.max(before), 0.0);
        rayon::scope(|scope| {
            let mut unknown = self.columns[p * before..].chunks_mut(p.max(1)).peekable();
            while let Some(column) = unknown.next() {
                let next = farthest(&nearest);
                if nearest[next] == 0.0 {
                    break;
                }
                guesses.push(next);
                scope.spawn(move |_| solver.distances_into(VertexId::from(next), column));
                if unknown.peek().is_some() {
                    pruned.lower(VertexId::from(next), &mut nearest);
                }
            }
        });
        for (guess, column) in guesses.into_iter().zip(self.columns[p * before..].chunks(p.max(1))) {
            if guess != farthest(&self.nearest) {
                break;
            }
            self.landmarks.push(guess);
            lower(&mut self.nearest, column);
        }
        self.columns.truncate(p * self.landmarks.len());
    }

    /// Number of landmarks so far.
    #[must_use]
    pub fn n_landmarks(&self) -> usize {
        self.landmarks.len()
    }

    /// The distances from the first `n` landmarks, or from all when there are fewer.
    ///
    /// # Errors
    /// [`GeodesicError::NoSamples`] when `n` is zero.
    pub fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError> {
        let (p, n) = (self.nearest.len(), n.min(self.landmarks.len()));
        if n == 0 {
            return Err(GeodesicError::NoSamples);
        }
        let columns = Matrix::from_column_slice(p, n, &self.columns[..p * n]);
        Ok(LandmarkDistances::new(self.landmarks[..n].to_vec(), columns)
            .unwrap_or_else(|fault| unreachable!("every column was checked: {fault}")))
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
