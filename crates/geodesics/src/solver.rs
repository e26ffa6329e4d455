//! The trait of all solvers.

use std::sync::{Mutex, PoisonError};

use base::{Budget, Exceeded};
use linalg::{DistanceMatrix, Matrix};
use rayon::prelude::*;
use surface::VertexId;

use crate::error::GeodesicError;
use crate::source::Source;

/// Distances from points of one surface to all of its vertices.
///
/// A solver is prepared once per surface. It may be kept and called from several threads at once. It keeps to the
/// [`Budget`] that it was prepared with: when that is exceeded, every call ends with an error, and what it has
/// written so far is not to be used.
///
/// ```
/// use canonform_geodesics::{Dijkstra, DistanceSolver, GeodesicError};
/// use mesh::shapes;
/// use surface::VertexId;
///
/// fn farthest(solver: &dyn DistanceSolver, source: VertexId) -> Result<f64, GeodesicError> {
///     Ok(solver.distances(source)?.into_iter().fold(0.0, f64::max))
/// }
/// // Along the edges of a sheet of 4 x 3 vertices, with the diagonals of its cells.
/// let sheet = shapes::grid(4, 3, 1.0).intrinsic();
/// let diameter = farthest(&Dijkstra::new(&sheet, &()), VertexId(0))?;
/// assert!((diameter - (1.0 + 2.0 * 2f64.sqrt())).abs() < 1e-12);
/// # Ok::<(), GeodesicError>(())
/// ```
pub trait DistanceSolver: Send + Sync + std::fmt::Debug {
    /// Number of vertices of the surface.
    fn n_vertices(&self) -> usize;

    /// The limits that the solver was prepared with.
    fn budget(&self) -> Budget {
        Budget::unlimited()
    }

    /// Writes the distance from the nearest of `sources` to every vertex, in mesh units; infinite where no edge or
    /// link leads and beyond `max_distance`.
    ///
    /// # Errors
    /// [`Exceeded`]; then `out` has no distances.
    ///
    /// # Panics
    /// If `out` does not have one entry per vertex, or a source belongs to another surface.
    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded>;

    /// Writes the distance from the vertex `source` to every vertex, as [`distances`](Self::distances) does.
    ///
    /// # Errors
    /// As [`solve_into`](Self::solve_into).
    ///
    /// # Panics
    /// If `out` does not have one entry per vertex, or `source` is out of range.
    fn distances_into(&self, source: VertexId, out: &mut [f64]) -> Result<(), Exceeded> {
        self.solve_into(&[Source::vertex(source)], f64::INFINITY, out)
    }

    /// The distance from `source` to every vertex, in mesh units; infinite where no edge or link leads.
    ///
    /// # Errors
    /// As [`solve_into`](Self::solve_into).
    ///
    /// # Panics
    /// If `source` is out of range.
    fn distances(&self, source: VertexId) -> Result<Vec<f64>, Exceeded> {
        let mut out = vec![f64::INFINITY; self.n_vertices()];
        self.distances_into(source, &mut out)?;
        Ok(out)
    }

    /// Whether [`lower`](Self::lower) only visits the part nearest to the new source.
    fn prunes(&self) -> bool {
        false
    }

    /// Lowers `nearest`, distances to the nearest of some sources, to the distance from `source` where it is less.
    ///
    /// # Errors
    /// [`Exceeded`]; then `nearest` may be changed in part.
    ///
    /// # Panics
    /// If `nearest` does not have one entry per vertex, or `source` is out of range.
    fn lower(&self, source: VertexId, nearest: &mut [f64]) -> Result<(), Exceeded> {
        let distances = self.distances(source)?;
        assert_eq!(distances.len(), nearest.len(), "one distance per vertex");
        nearest.iter_mut().zip(distances).for_each(|(near, distance)| *near = near.min(distance));
        Ok(())
    }

    /// The distances from several vertices, `n_vertices` x `sources.len()`, computed in parallel; the result does not
    /// depend on the number of threads.
    ///
    /// # Errors
    /// [`Exceeded`], also if the columns do not fit into memory.
    ///
    /// # Panics
    /// If a source is out of range.
    fn distance_columns(&self, sources: &[VertexId]) -> Result<Matrix, Exceeded> {
        let p = self.n_vertices();
        let mut columns = self.budget().vector(p.saturating_mul(sources.len()))?;
        if p > 0 {
            let columns = columns.par_chunks_mut(p).zip(sources);
            columns.try_for_each(|(column, source)| self.distances_into(*source, column))?;
        }
        Ok(Matrix::from_vec(p, sources.len(), columns))
    }

    /// The distances between all pairs of vertices, `n_vertices` x `n_vertices`, each the mean of both directions.
    ///
    /// # Errors
    /// [`GeodesicError::Matrix`] if some vertex cannot be reached from another; [`GeodesicError::Exceeded`].
    fn distance_matrix(&self) -> Result<DistanceMatrix, GeodesicError> {
        let all: Vec<VertexId> = (0..self.n_vertices()).map(VertexId::from).collect();
        Ok(DistanceMatrix::from_rows(all.len(), self.distance_columns(&all)?.data.into())?)
    }
}

/// The distance, or infinity beyond the limit, where fronts leave tentative distances.
#[inline]
pub(crate) fn within(distance: f64, max_distance: f64) -> f64 {
    if distance <= max_distance { distance } else { f64::INFINITY }
}

/// Scratch memory that calls borrow and return, so that only the first calls allocate.
#[derive(Debug, Default)]
pub(crate) struct Pool<T>(Mutex<Vec<T>>);

impl<T: Default> Pool<T> {
    /// Runs `work` on scratch memory in the state in which its last user left it.
    pub(crate) fn with<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let lock = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let mut scratch = lock().pop().unwrap_or_default();
        let result = work(&mut scratch);
        lock().push(scratch);
        result
    }
}
