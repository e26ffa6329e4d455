//! Distances between all pairs of vertices.

use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Result, bail};
use base::files::{FileError, fill_atomically};
use base::object;
use base::terminal::Bars;
use canonform::Exceeded;
use canonform::geodesics::{AllPairs, Asymmetry};
use npyz::WriterBuilder;

use super::task::Task;
use crate::input::named;
use crate::output::{Answer, decimal_bytes, shown};

/// Default memory for distances, in bytes.
const DEFAULT_MEMORY: usize = 1 << 30;

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
    let Task { args, surface, common, .. } = task;
    let memory = args.limits.memory.unwrap_or(DEFAULT_MEMORY);
    let pairs = AllPairs::new(surface, task.solver, memory).map_err(|fault| named(&args.mesh, fault))?;
    let (start, n_vertices) = (Instant::now(), pairs.n_vertices());
    let observer = Bars::with_budget(common.quiet, args.limits.budget());
    let mut asymmetry = Asymmetry::default();
    let written = fill_atomically(&task.output.path, |file| {
        // The header, and then the numbers in any order.
        let shape = [n_vertices as u64; 2];
        let array: npyz::NpyWriter<f64, _> =
            npyz::WriteOptions::new().default_dtype().shape(&shape).writer(&mut *file).begin_nd()?;
        drop(array);
        asymmetry = pairs.write(file, &observer)?;
        Ok(())
    });
    written.map_err(|fault| stopped(&fault).map_or(fault.into(), |limit| named(&args.mesh, limit.into())))?;
    drop(observer);
    let json = object! {
        method: <&str>::from(args.method),
        n_vertices,
        output: &task.output.name,
        // The difference between the two directions, which are averaged.
        asymmetry,
        seconds: object! {
            load: surface.input.load_seconds,
            setup: task.setup,
            // All sources, on all threads, with writing the file.
            all_pairs: start.elapsed().as_secs_f64(),
        },
        // Input vertices without a path to any other.
        unreached: &surface.input.report.dropped_vertices,
        repair: &surface.input.report,
    };
    task.output.report(common, &json, |json| {
        let percent = |share: f64| format!("{:.3} %", 100.0 * share);
        let [mean, most] = [json.asymmetry.mean, json.asymmetry.largest].map(percent);
        let mut facts = vec![("seconds", format!("{:.1}", json.seconds.all_pairs))];
        let n = json.unreached.len();
        facts.extend((n > 0).then(|| ("unreached", format!("{n} vertices, written as inf"))));
        let output = shown(json.output);
        let answer = Answer {
            sentence: format!("{output} holds the distances between all pairs of {n_vertices} vertices"),
            facts,
            details: vec![
                ("method", json.method.to_owned()),
                ("setup", format!("{:.1} ms", 1e3 * json.seconds.setup)),
                ("asymmetry", format!("{mean} on average, {most} at most; both directions are averaged")),
            ],
        };
        answer.text(common)
    })
}

/// The limit that ended the work, if it was not the file that failed.
fn stopped(fault: &FileError) -> Option<Exceeded> {
    fault.source.get_ref()?.downcast_ref().copied()
}
