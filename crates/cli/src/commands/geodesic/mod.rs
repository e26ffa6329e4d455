//! `canonform geodesic`.
//!
//! `rows` (distances from sources), `paths` (to targets), `pairs` (between all vertices), `task` (what they share).

mod pairs;
mod paths;
mod rows;
mod task;

use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use canonform::mesh::io::{Content, writable};

use self::task::Task;
use crate::args::{Common, GeodesicArgs, geodesic_method};
use crate::input::{check_there, named, read_reported};
use crate::output::Output;

/// Measures distances or finds paths.
pub(crate) fn geodesic(args: &GeodesicArgs, common: &Common) -> Result<ExitCode> {
    type Write = fn(Task<'_>) -> Result<ExitCode>;
    check_there(&args.mesh)?;
    let (what, formats, write): (_, Vec<&str>, Write) = if args.all_pairs {
        ("all pairs", vec!["npy"], pairs::write)
    } else if args.path_to.is_empty() {
        ("distances", ["npy", "csv"].into_iter().chain(writable(Content::Field)).collect(), rows::write)
    } else {
        ("paths", writable(Content::Lines).chain(["csv", "json"]).collect(), paths::write)
    };
    let method = geodesic_method(&args.marching, args.method)?;
    let output = Output::new(&args.output, what, &formats, Some(&args.output_format), common)?;
    let (mesh, surface) = read_reported(&args.mesh, &args.repair, common)?;
    if args.all_pairs {
        pairs::check_size(surface.n_input_vertices(), args.force)?;
    }
    let start = Instant::now();
    let solver = method
        .prepare(surface.intrinsic(), &args.limits.budget())
        .map_err(|fault| named(&args.mesh, fault.into()))?;
    let setup = surface.input.repair_seconds + start.elapsed().as_secs_f64();
    write(Task { args, common, output, mesh: &mesh, surface: &surface, solver: solver.as_ref(), setup })
}
