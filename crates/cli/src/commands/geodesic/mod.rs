//! `canonform geodesic`.
//!
//! `rows` (distances from sources), `paths` (to targets), `pairs` (between all vertices).

mod pairs;
mod paths;
mod rows;

use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Result, bail};
use canonform::geodesics::{DistanceSolver, Source};
use canonform::{InputPoint, Surface};
use mesh::io::{Content, or_list, writable};
use serde::Serialize;

use super::{named, read_surface};
use crate::args::{Common, GeodesicArgs};
use crate::output::{check_folder, extension};
use terminal::Bars;

/// Measures distances or finds paths, and writes them.
pub(crate) fn geodesic(args: &GeodesicArgs, common: &Common) -> Result<ExitCode> {
    let output = Output::of(args);
    let format = extension(&args.output);
    let (what, formats) = output.formats();
    if !formats.contains(&format.as_str()) {
        bail!("{}: {what} are written as {}", args.output.display(), or_list(formats));
    }
    check_folder(&args.output)?;
    let surface = read_surface(&args.mesh, &args.repair)?;
    let start = Instant::now();
    let method = args.marching.of(args.method);
    let solver = method.prepare(&surface.intrinsic).map_err(|fault| named(&args.mesh, fault.into()))?;
    let setup = surface.repair_seconds + start.elapsed().as_secs_f64();
    let task = Task { args, common, format: &format, surface: &surface, solver: solver.as_ref(), setup };
    match output {
        Output::Rows => rows::write(&task)?,
        Output::Paths => paths::write(&task)?,
        Output::Pairs => pairs::write(&task)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// What is asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Output {
    Rows,
    Paths,
    Pairs,
}

impl Output {
    fn of(args: &GeodesicArgs) -> Self {
        match (args.all_pairs, args.path_to.is_empty()) {
            (true, _) => Self::Pairs,
            (false, true) => Self::Rows,
            (false, false) => Self::Paths,
        }
    }

    /// Its name and the extensions of its files.
    fn formats(self) -> (&'static str, Vec<&'static str>) {
        match self {
            Self::Rows => ("distances", ["npy", "csv"].into_iter().chain(writable(Content::Field)).collect()),
            Self::Paths => ("paths", writable(Content::Lines).chain(["csv", "json"]).collect()),
            Self::Pairs => ("all pairs", vec!["npy"]),
        }
    }
}

/// A surface that is ready, and what is wanted of it.
struct Task<'a> {
    args: &'a GeodesicArgs,
    common: &'a Common,
    /// Extension of the output.
    format: &'a str,
    surface: &'a Surface,
    solver: &'a dyn DistanceSolver,
    /// Seconds to get ready.
    setup: f64,
}

/// Seconds of each stage, the solver's on one thread.
#[derive(Serialize)]
struct Seconds {
    load: f64,
    setup: f64,
    per_source: Vec<f64>,
}

/// Distances from one source, or from the nearest of several.
struct Row {
    /// Where they start, as the user writes it.
    from: Vec<InputPoint>,
    sources: Vec<Source>,
    /// One for each vertex of the repaired mesh.
    distances: Vec<f64>,
}

impl Task<'_> {
    /// Solves for every source, or once for all of them, and says how long it took.
    fn solve(&self) -> Result<(Vec<Row>, Seconds)> {
        let Self { args, surface, .. } = self;
        let located = |point: &InputPoint| {
            let source = Source::new(&surface.intrinsic, surface.locate(point)?)?;
            Ok((*point, source))
        };
        let points: Result<Vec<_>, _> = args.source.iter().map(located).collect();
        let points = points.map_err(|fault| named(&args.mesh, fault))?;
        let groups = points.chunks(if args.nearest { points.len() } else { 1 });
        let bars = Bars::new(self.common.quiet);
        let bar = bars.bar("distances", groups.len());
        let mut rows = Vec::with_capacity(groups.len());
        let mut per_source = Vec::with_capacity(groups.len());
        for group in groups {
            let (from, sources): (_, Vec<Source>) = group.iter().cloned().unzip();
            let mut distances = vec![0.0; self.solver.n_vertices()];
            let start = Instant::now();
            self.solver.solve_into(&sources, args.max_distance.unwrap_or(f64::INFINITY), &mut distances);
            per_source.push(start.elapsed().as_secs_f64());
            rows.push(Row { from, sources, distances });
            bar.inc(1);
        }
        bar.finish_and_clear();
        Ok((rows, Seconds { load: surface.load_seconds, setup: self.setup, per_source }))
    }
}

/// Several points, as the user writes them.
fn spelled(points: &[InputPoint]) -> String {
    points.iter().map(ToString::to_string).collect::<Vec<_>>().join(",")
}
