//! Distances on meshes whose lengths are so small or large that their products vanish or overflow.

use budget::{Budget, Exceeded};
use linalg::Matrix;
use surface::VertexId;

use crate::solver::{DistanceSolver, PrunedSolver};
use crate::source::Source;

/// A solver for the same surface with all lengths divided by a power of two, which is exact.
#[derive(Debug)]
pub(crate) struct InUnits {
    pub(crate) solver: Box<dyn DistanceSolver>,
    /// The unit, in mesh units.
    pub(crate) unit: f64,
}

impl InUnits {
    fn rescale(&self, distances: &mut [f64]) {
        distances.iter_mut().for_each(|distance| *distance *= self.unit);
    }
}

impl DistanceSolver for InUnits {
    fn n_vertices(&self) -> usize {
        self.solver.n_vertices()
    }

    fn budget(&self) -> Budget {
        self.solver.budget()
    }

    fn solve_into(&self, sources: &[Source], max_distance: f64, out: &mut [f64]) -> Result<(), Exceeded> {
        let sources: Vec<Source> = sources.iter().map(|source| source.in_units_of(self.unit)).collect();
        self.solver.solve_into(&sources, max_distance / self.unit, out)?;
        self.rescale(out);
        Ok(())
    }

    fn distances_into(&self, source: VertexId, out: &mut [f64]) -> Result<(), Exceeded> {
        self.solver.distances_into(source, out)?;
        self.rescale(out);
        Ok(())
    }

    fn pruned(&self) -> Option<&dyn PrunedSolver> {
        self.solver.pruned().map(|_| self as &dyn PrunedSolver)
    }

    fn distance_columns(&self, sources: &[VertexId]) -> Result<Matrix, Exceeded> {
        let mut columns = self.solver.distance_columns(sources)?;
        self.rescale(columns.as_mut_slice());
        Ok(columns)
    }
}

impl PrunedSolver for InUnits {
    fn lower(&self, source: VertexId, nearest: &mut [f64]) -> Result<(), Exceeded> {
        let Some(pruned) = self.solver.pruned() else { return Ok(()) };
        nearest.iter_mut().for_each(|distance| *distance /= self.unit);
        let result = pruned.lower(source, nearest);
        self.rescale(nearest);
        result
    }
}
