//! Distances between all pairs of vertices.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Result, bail};
use base::files::FileError;
use base::terminal::Bars;
use canonform::Exceeded;
use canonform::geodesics::{AllPairs, Asymmetry};
use canonform::mesh::RepairReport;
use canonform::surface::VertexId;
use serde::Serialize;

use super::task::Task;
use crate::input::named;
use crate::output::{Answer, decimal_bytes, fill_npy, shown};

/// Default memory for distances, in bytes.
const DEFAULT_MEMORY: usize = 1 << 30;

#[derive(Serialize)]
struct PairsJson {
    method: &'static str,
    n_vertices: usize,
    output: PathBuf,
    /// The difference between the two directions, which are averaged.
    asymmetry: Asymmetry,
    seconds: Seconds,
    /// Input vertices without a path to any other.
    unreached: Vec<VertexId>,
    repair: RepairReport,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    setup: f64,
    /// All sources, on all threads, with writing the file.
    all_pairs: f64,
}

/// The largest file that is written without --force, in bytes: 111,803 vertices.
const LARGEST_FILE: u128 = 100_000_000_000;

/// Announces a large file, and refuses one that is likely a mistake.
pub(super) fn check_size(n_vertices: usize, force: bool) -> Result<()> {
    let bytes = (n_vertices as u128).pow(2) * 8;
    let size = format!("all pairs of {n_vertices} vertices take a file of {}", decimal_bytes(bytes));
    if bytes > LARGEST_FILE && !force {
        bail!(
            "{size}; measure from some vertices with --source, simplify the mesh, or pass --force to write it all \
             the same"
        );
    }
    if bytes > LARGEST_FILE / 100 {
        base::terminal::note(&size);
    }
    Ok(())
}

/// Measures, writes and reports the distances between all pairs.
pub(super) fn write(task: Task<'_>) -> Result<ExitCode> {
    let Task { args, surface, .. } = task;
    let memory = args.limits.memory.unwrap_or(DEFAULT_MEMORY);
    let pairs = AllPairs::new(surface, task.solver, memory).map_err(|fault| named(&args.mesh, fault))?;
    let start = Instant::now();
    let mut asymmetry = Asymmetry::default();
    fill_npy(task.output.path(), [pairs.n_vertices(); 2], |file| {
        asymmetry = pairs.write(file, &Bars::with_budget(task.common.quiet, args.limits.budget()))?;
        Ok(())
    })
    .map_err(|fault| stopped(&fault).map_or(fault, |limit| named(&args.mesh, limit.into())))?;
    let json = PairsJson {
        method: args.method.into(),
        n_vertices: pairs.n_vertices(),
        output: task.output.name(),
        asymmetry,
        seconds: Seconds {
            load: surface.input.load_seconds,
            setup: task.setup,
            all_pairs: start.elapsed().as_secs_f64(),
        },
        unreached: surface.input.report.dropped_vertices.clone(),
        repair: surface.input.report.clone(),
    };
    let common = task.common;
    task.output.report(common, &json, |json| answer(json).text(common))
}

/// The limit that ended the work, if it was not the file that failed.
fn stopped(fault: &anyhow::Error) -> Option<Exceeded> {
    let FileError { source, .. } = fault.downcast_ref()?;
    source.get_ref()?.downcast_ref().copied()
}

fn answer(json: &PairsJson) -> Answer {
    let percent = |share: f64| format!("{:.3} %", 100.0 * share);
    let Asymmetry { mean, largest } = json.asymmetry;
    let mut facts = vec![("seconds", format!("{:.1}", json.seconds.all_pairs))];
    if !json.unreached.is_empty() {
        facts.push(("unreached", format!("{} vertices, written as inf", json.unreached.len())));
    }
    let (output, n) = (shown(&json.output), json.n_vertices);
    let asymmetry =
        format!("{} on average, {} at most; both directions are averaged", percent(mean), percent(largest));
    Answer {
        sentence: format!("{output} holds the distances between all pairs of {n} vertices"),
        facts,
        details: vec![
            ("method", json.method.to_owned()),
            ("setup", format!("{:.1} ms", 1e3 * json.seconds.setup)),
            ("asymmetry", asymmetry),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_beyond_100_gb_need_force() {
        let refused = check_size(750_000, false).unwrap_err().to_string();
        assert!(
            refused.contains("750000 vertices take a file of 4.5 TB") && refused.contains("--force"),
            "{refused}"
        );
        assert!(check_size(750_000, true).is_ok() && check_size(111_803, false).is_ok());
        assert!(check_size(111_804, false).is_err());
        assert_eq!([12, 12_345, 12_345_678].map(decimal_bytes), ["0.0 kB", "12.3 kB", "12.3 MB"]);
    }
}
