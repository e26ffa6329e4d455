//! Distances from sources: one row, or one colored mesh, per source.

use std::path::PathBuf;
use std::process::ExitCode;

use anyhow::{Context, Result, bail};
use base::object;
use canonform::surface::VertexId;

use super::task::{Row, Task, milliseconds, spelled};
use crate::output::{Answer, beside, count, shown, write_colored};
use crate::table::{write_csv, write_npy};

/// Measures, writes and reports distances.
pub(super) fn write(task: Task<'_>) -> Result<ExitCode> {
    let Task { args, surface, common, .. } = task;
    let solved = task.solve()?;
    let rows: Vec<Vec<f64>> =
        solved.iter().map(|row| surface.in_input_order(&row.distances, f64::INFINITY)).collect();
    let outputs = write_rows(&task, &solved, &rows)?;
    let (n_vertices, dropped) = (surface.n_input_vertices(), &surface.input.report.dropped_vertices);
    let is_infinite = |v: &VertexId| rows.iter().any(|row| !row[v.index()].is_finite());
    let infinite = |row: &Vec<f64>| row.iter().filter(|d| d.is_infinite()).count();
    // A repaired surface is connected: with a limit, vertices that are not reached lie beyond it.
    let (unreached, beyond): (Vec<VertexId>, _) = match args.max_distance {
        Some(_) => (dropped.clone(), rows.iter().map(|row| infinite(row) - dropped.len()).collect()),
        None => ((0..n_vertices).map(VertexId::from).filter(is_infinite).collect(), vec![0; rows.len()]),
    };
    let finite = |row: &Vec<f64>| row.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max);
    let json = object! {
        method: <&str>::from(args.method),
        n_vertices,
        sources: &args.source,
        outputs,
        // The largest finite distance in each row.
        farthest: rows.iter().map(finite).collect::<Vec<f64>>(),
        seconds: object! {
            load: surface.input.load_seconds,
            setup: task.setup,
            per_source: solved.iter().map(|row| row.seconds).collect::<Vec<_>>(),
        },
        // Input vertices without a path from the sources.
        unreached,
        max_distance: args.max_distance,
        // Number of vertices beyond it, in each row.
        beyond,
        repair: &surface.input.report,
    };
    task.output.report(common, &json, |json| {
        let from = match &solved[..] {
            [row] if row.from.len() == 1 => spelled(&row.from),
            [_] => format!("the nearest of {}", count(args.source.len(), "source")),
            rows => format!("each of {}", count(rows.len(), "source")),
        };
        let holds = match &json.outputs[..] {
            [output] => format!("{} holds", shown(output)),
            outputs => format!("{} files hold", outputs.len()),
        };
        let farthest = json.farthest.iter().copied().fold(0.0, f64::max);
        let mut facts = Vec::new();
        if let (Some(limit), beyond @ 1..) = (json.max_distance, json.beyond.iter().sum()) {
            let beyond = count(beyond, "distance");
            facts.push(("beyond", format!("{beyond} farther than {limit}, written as inf")));
        }
        let n = json.unreached.len();
        facts.extend((n > 0).then(|| ("unreached", format!("{n} vertices, written as inf"))));
        let mut details =
            vec![("method", json.method.to_owned()), ("setup", milliseconds(json.seconds.setup))];
        details.extend(solved.iter().zip(&json.farthest).map(|(row, farthest)| {
            let name = if row.from.len() == 1 { "source" } else { "nearest of" };
            let (from, time) = (spelled(&row.from), milliseconds(row.seconds));
            (name, format!("{from}: farthest {farthest:.6}, {time}"))
        }));
        details.extend(json.outputs.iter().map(|path| ("wrote", path.display().to_string())));
        let sentence = format!(
            "{holds} the distances from {from} to {n_vertices} vertices; the farthest is {farthest:.6} away"
        );
        Answer { sentence, facts, details }.text(common)
    })
}

/// Writes the distances, in the vertex order of the input, and returns the files.
fn write_rows(task: &Task, solved: &[Row], rows: &[Vec<f64>]) -> Result<Vec<PathBuf>> {
    let (output, format) = (&task.output.path, task.output.format.as_str());
    match format {
        "npy" => {
            let shape = [rows.len(), task.surface.n_input_vertices()];
            write_npy(output, &shape, rows.iter().flatten().copied())?;
        }
        "csv" => write_csv(output, rows.iter().map(|row| row.iter().copied()))?,
        _ if task.output.is_stream() && rows.len() > 1 => {
            bail!("several meshes cannot go to standard output; name a file with -o, or write .npy")
        }
        _ => {
            let is_one = rows.len() == 1;
            let write = |(row, distances): (&Row, &Vec<f64>)| {
                // Some systems do not allow colons in file names.
                let source = spelled(&row.from).replace(':', "_");
                let path = if is_one { output.to_owned() } else { beside(output, &source) };
                write_colored(&path, task.mesh, "distance", distances)
                    .with_context(|| format!("source {}", spelled(&row.from)))?;
                Ok(if is_one { task.output.name.clone() } else { path })
            };
            return solved.iter().zip(rows).map(write).collect();
        }
    }
    Ok(vec![task.output.name.clone()])
}
