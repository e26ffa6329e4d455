//! Distances between all pairs of vertices.

use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use canonform::{AllPairs, Asymmetry};
use mesh::RepairReport;
use serde::Serialize;
use surface::VertexId;
use terminal::Bars;

use super::task::Task;
use crate::input::named;
use crate::output::{facts, fill_npy, report};

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

/// Measures, writes and reports the distances between all pairs.
pub(super) fn write(task: &Task) -> Result<ExitCode> {
    let Task { args, surface, .. } = task;
    let memory = args.limits.memory.unwrap_or(DEFAULT_MEMORY);
    let pairs = AllPairs::new(surface, task.solver, memory).map_err(|fault| named(&args.mesh, fault))?;
    let start = Instant::now();
    let mut asymmetry = Asymmetry::default();
    fill_npy(&args.output, [pairs.n_vertices(); 2], |file| {
        asymmetry = pairs.write(file, &Bars::with_budget(task.common.quiet, args.limits.budget()))?;
        Ok(())
    })?;
    let json = PairsJson {
        method: args.method.name(),
        n_vertices: pairs.n_vertices(),
        output: args.output.clone(),
        asymmetry,
        seconds: Seconds {
            load: surface.load_seconds,
            setup: task.setup,
            all_pairs: start.elapsed().as_secs_f64(),
        },
        unreached: surface.repaired.report.dropped_vertices.clone(),
        repair: surface.repaired.report.clone(),
    };
    report(task.common, &json, table)
}

fn table(json: &PairsJson) -> String {
    let percent = |share: f64| format!("{:.3} %", 100.0 * share);
    let Asymmetry { mean, largest } = json.asymmetry;
    let mut lines = vec![
        ("method", json.method.to_owned()),
        ("vertices", json.n_vertices.to_string()),
        ("setup", format!("{:.1} ms", 1e3 * json.seconds.setup)),
        ("all pairs", format!("{:.1} s", json.seconds.all_pairs)),
        (
            "asymmetry",
            format!(
                "{} on average, {} at most; both directions are averaged",
                percent(mean),
                percent(largest)
            ),
        ),
    ];
    if !json.unreached.is_empty() {
        lines.push(("unreached", format!("{} vertices, written as inf", json.unreached.len())));
    }
    lines.push(("wrote", json.output.display().to_string()));
    facts(&lines)
}
