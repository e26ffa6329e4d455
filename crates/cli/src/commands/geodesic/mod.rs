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
use mesh::io::{Content, writable};

use self::task::Task;
use crate::args::{Common, GeodesicArgs};
use crate::input::{named, read_surface};
use crate::output::{check_folder, check_format};

type Write = fn(&Task) -> Result<ExitCode>;

/// Measures distances or finds paths.
pub(crate) fn geodesic(args: &GeodesicArgs, common: &Common) -> Result<ExitCode> {
    let (what, formats, write): (_, Vec<&str>, Write) = if args.all_pairs {
        ("all pairs", vec!["npy"], pairs::write)
    } else if args.path_to.is_empty() {
        ("distances", ["npy", "csv"].into_iter().chain(writable(Content::Field)).collect(), rows::write)
    } else {
        ("paths", writable(Content::Lines).chain(["csv", "json"]).collect(), paths::write)
    };
    let format = check_format(&args.output, what, &formats)?;
    check_folder(&args.output)?;
    let surface = read_surface(&args.mesh, &args.repair)?;
    let start = Instant::now();
    let method = args.marching.of(args.method);
    let solver = method.prepare(&surface.intrinsic).map_err(|fault| named(&args.mesh, fault.into()))?;
    let setup = surface.repair_seconds + start.elapsed().as_secs_f64();
    write(&Task { args, common, format: &format, surface: &surface, solver: solver.as_ref(), setup })
}
