//! Distances from sources: one row, or one coloured mesh, per source.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use canonform::mesh::{InputPoint, RepairReport};
use serde::Serialize;

use super::task::{Row, Seconds, Task, spelled};
use crate::output::{Answer, count, shown, write_colored, write_csv, write_npy};

#[derive(Serialize)]
struct RowsJson {
    method: &'static str,
    n_vertices: usize,
    sources: Vec<InputPoint>,
    outputs: Vec<PathBuf>,
    /// The largest finite distance in each row.
    farthest: Vec<f64>,
    seconds: Seconds,
    /// Input vertices without a path from the sources.
    unreached: Vec<u32>,
    max_distance: Option<f64>,
    /// Number of vertices beyond `max_distance`, in each row.
    beyond: Vec<usize>,
    repair: RepairReport,
}

/// Measures, writes and reports distances.
pub(super) fn write(task: Task<'_>) -> Result<ExitCode> {
    let Task { args, surface, .. } = task;
    let (solved, seconds) = task.solve()?;
    let rows: Vec<Vec<f64>> =
        solved.iter().map(|row| surface.in_input_order(&row.distances, f64::INFINITY)).collect();
    let outputs = write_rows(&task, &solved, &rows)?;
    let is_infinite = |v: &u32| rows.iter().any(|row| !row[*v as usize].is_finite());
    // A repaired surface is connected: with a limit, vertices that are not reached lie beyond it.
    let unreached = if args.max_distance.is_some() {
        surface.input.report.dropped_vertices.iter().map(|v| v.0).collect()
    } else {
        (0..surface.n_input_vertices() as u32).filter(is_infinite).collect()
    };
    let infinite = |row: &Vec<f64>| row.iter().filter(|d| d.is_infinite()).count();
    let finite = |row: &Vec<f64>| row.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
    let dropped = surface.input.report.dropped_vertices.len();
    let json = RowsJson {
        method: args.method.into(),
        n_vertices: surface.n_input_vertices(),
        sources: args.source.clone(),
        outputs,
        farthest: rows.iter().map(finite).collect(),
        seconds,
        unreached,
        max_distance: args.max_distance,
        beyond: match args.max_distance {
            Some(_) => rows.iter().map(|row| infinite(row) - dropped).collect(),
            None => vec![0; rows.len()],
        },
        repair: surface.input.report.clone(),
    };
    let common = task.common;
    task.output.report(common, &json, |json| answer(json, &solved).text(common))
}

fn answer(json: &RowsJson, rows: &[Row]) -> Answer {
    let from = match rows {
        [row] if row.from.len() == 1 => spelled(&row.from),
        [_] => format!("the nearest of {}", count(json.sources.len(), "source")),
        rows => format!("each of {}", count(rows.len(), "source")),
    };
    let holds = match &json.outputs[..] {
        [output] => format!("{} holds", shown(output)),
        outputs => format!("{} files hold", outputs.len()),
    };
    let farthest = json.farthest.iter().copied().fold(0.0, f64::max);
    let (beyond, unreached) = (json.beyond.iter().sum::<usize>(), json.unreached.len());
    let mut facts = Vec::new();
    if let (Some(limit), 1..) = (json.max_distance, beyond) {
        facts.push(("beyond", format!("{} farther than {limit}, written as inf", count(beyond, "distance"))));
    }
    if unreached > 0 {
        facts.push(("unreached", format!("{unreached} vertices, written as inf")));
    }
    let milliseconds = |seconds: f64| format!("{:.2} ms", 1e3 * seconds);
    let mut details = vec![("method", json.method.to_owned()), ("setup", milliseconds(json.seconds.setup))];
    for (i, row) in rows.iter().enumerate() {
        let name = if row.from.len() == 1 { "source" } else { "nearest of" };
        let (farthest, time) = (json.farthest[i], milliseconds(json.seconds.per_source[i]));
        details.push((name, format!("{}: farthest {farthest:.6}, {time}", spelled(&row.from))));
    }
    details.extend(json.outputs.iter().map(|path| ("wrote", path.display().to_string())));
    Answer {
        sentence: format!(
            "{holds} the distances from {from} to {} vertices; the farthest is {farthest:.6} away",
            json.n_vertices
        ),
        facts,
        details,
    }
}

/// Writes the distances, in the vertex order of the input, and returns the files.
fn write_rows(task: &Task, solved: &[Row], rows: &[Vec<f64>]) -> Result<Vec<PathBuf>> {
    let (output, slices) = (task.output.path(), rows.iter().map(Vec::as_slice));
    match task.output.format() {
        "npy" => write_npy(output, task.surface.n_input_vertices(), slices)?,
        "csv" => write_csv(output, slices)?,
        _ => {
            if task.output.is_stream() && rows.len() > 1 {
                bail!("several meshes cannot go to standard output; name a file with -o, or write .npy");
            }
            let mut outputs = Vec::new();
            for (row, distances) in solved.iter().zip(rows) {
                let path = if rows.len() == 1 {
                    output.to_owned()
                } else {
                    numbered(output, &row.from, task.output.format())
                };
                write_colored(&path, task.mesh, "distance", distances)
                    .with_context(|| format!("source {}", spelled(&row.from)))?;
                outputs.push(if task.output.is_stream() { task.output.name() } else { path });
            }
            return Ok(outputs);
        }
    }
    Ok(vec![task.output.name()])
}

/// `out.ply` for source 7 of several: `out-7.ply`.
fn numbered(output: &Path, from: &[InputPoint], extension: &str) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    // Some systems do not allow colons in file names.
    output.with_file_name(format!("{stem}-{}.{extension}", spelled(from).replace(':', "_")))
}
