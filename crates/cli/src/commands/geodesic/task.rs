//! A surface with its solver, and the rows of distances that paths and files are made of.

use std::time::Instant;

use anyhow::Result;
use base::terminal::Bars;
use canonform::Surface;
use canonform::geodesics::{DistanceSolver, Source};
use canonform::mesh::{InputPoint, TriMesh};

use crate::args::{Common, GeodesicArgs};
use crate::input::named;
use crate::output::Output;

/// A surface with its solver, and what to do with them.
pub(super) struct Task<'a> {
    pub(super) args: &'a GeodesicArgs,
    pub(super) common: &'a Common,
    pub(super) output: Output,
    /// The input.
    pub(super) mesh: &'a TriMesh,
    pub(super) surface: &'a Surface,
    pub(super) solver: &'a dyn DistanceSolver,
    /// Seconds to repair the mesh and to prepare the solver.
    pub(super) setup: f64,
}

/// Distances from one source, or from the nearest of several.
pub(super) struct Row {
    /// The sources as the user wrote them.
    pub(super) from: Vec<InputPoint>,
    pub(super) sources: Vec<Source>,
    /// One for each vertex of the repaired mesh.
    pub(super) distances: Vec<f64>,
    /// The time of the solver, on one thread.
    pub(super) seconds: f64,
}

impl Task<'_> {
    /// Solves for every source, or once for the nearest of them.
    pub(super) fn solve(&self) -> Result<Vec<Row>> {
        let Self { args, surface, .. } = self;
        let located = |point: &InputPoint| {
            let source = Source::new(surface.intrinsic(), surface.locate(point)?)?;
            Ok((*point, source))
        };
        let points: Result<Vec<_>, _> = args.source.iter().map(located).collect();
        let points = points.map_err(|fault| named(&args.mesh, fault))?;
        let groups = points.chunks(if args.nearest { points.len() } else { 1 });
        let bar = Bars::new(self.common.quiet).bar("distances", groups.len());
        let mut rows = Vec::with_capacity(groups.len());
        for group in groups {
            let (from, sources): (_, Vec<Source>) = group.iter().cloned().unzip();
            let mut distances = vec![0.0; self.solver.n_vertices()];
            let start = Instant::now();
            self.solver
                .solve_into(&sources, args.max_distance.unwrap_or(f64::INFINITY), &mut distances)
                .map_err(canonform::Error::from)?;
            rows.push(Row { from, sources, distances, seconds: start.elapsed().as_secs_f64() });
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok(rows)
    }
}

/// Points as the user writes them.
pub(super) fn spelled(points: &[InputPoint]) -> String {
    points.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}

pub(super) fn milliseconds(seconds: f64) -> String {
    format!("{:.2} ms", 1e3 * seconds)
}
