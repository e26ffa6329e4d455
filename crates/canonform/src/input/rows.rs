//! Distances from several sources, in the order of the input.

use base::Observer;
use geodesics::{DistanceSolver, Source};
use mesh::Surface;
use rayon::prelude::*;

use crate::error::Error;

/// One row of distances to the vertices of the input for each source, one after the other, measured in parallel up to
/// `max_distance`. Vertices beyond it, and those that the repair dropped, are infinitely far. `observer` counts every row as a
/// step.
///
/// # Errors
/// [`Error::Geodesic`] and [`Error::Exceeded`].
pub fn distance_rows(
    surface: &Surface,
    solver: &dyn DistanceSolver,
    sources: &[Source],
    max_distance: f64,
    observer: &dyn Observer,
) -> Result<Vec<f64>, Error> {
    let p = surface.n_input_vertices();
    observer.begin("distances", sources.len());
    let mut rows = solver.budget().vector(p.saturating_mul(sources.len()))?;
    rows.par_chunks_mut(p.max(1)).zip(sources).try_for_each(|(row, source)| {
        let mut solved = vec![0.0; solver.n_vertices()];
        solver.solve_into(std::slice::from_ref(source), max_distance, &mut solved)?;
        row.copy_from_slice(&surface.in_input_order(&solved, f64::INFINITY));
        observer.step();
        Ok::<_, Error>(())
    })?;
    Ok(rows)
}
