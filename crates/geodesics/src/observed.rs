//! A solver whose solves are the steps of an observer.

use base::{Budget, Exceeded, Observer};
use linalg::Matrix;
use surface::VertexId;

use crate::solver::DistanceSolver;
use crate::source::Source;

/// Sources solved between two reports of progress.
const BATCH: usize = 64;

/// A solver that reports every solve as a step of its observer.
pub struct Observed<'a> {
    /// Finds the distances, within its own budget.
    pub solver: &'a dyn DistanceSolver,
    /// Is told of every step.
    pub observer: &'a dyn Observer,
}

impl std::fmt::Debug for Observed<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.solver.fmt(f)
    }
}

impl DistanceSolver for Observed<'_> {
    fn n_vertices(&self) -> usize {
        self.solver.n_vertices()
    }

    fn budget(&self) -> Budget {
        self.solver.budget()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        self.solver.solve_into(sources, max_distance, out)?;
        self.observer.step();
        Ok(())
    }

    fn distance_columns(&self, sources: &[VertexId]) -> Result<Matrix, Exceeded> {
        let p = self.n_vertices();
        let columns = self.budget().vector(p.saturating_mul(sources.len()))?;
        let mut columns = Matrix::from_vec(p, sources.len(), columns);
        for (i, batch) in sources.chunks(BATCH).enumerate() {
            // Some solvers solve many sources at once faster than one by one.
            let solved = self.solver.distance_columns(batch)?;
            columns.columns_mut(i * BATCH, batch.len()).copy_from(&solved);
            batch.iter().for_each(|_| self.observer.step());
        }
        Ok(columns)
    }

    fn prunes(&self) -> bool {
        self.solver.prunes()
    }

    fn lower(&self, source: VertexId, nearest: &mut [f64]) -> Result<(), Exceeded> {
        self.solver.lower(source, nearest)
    }
}
