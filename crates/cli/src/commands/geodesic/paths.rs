//! Shortest paths from sources to targets.

use std::borrow::Cow;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use base::files::write_atomically;
use base::object;
use canonform::geodesics::{DistanceSolver, Exact, PathPoint, PathTracer, SurfacePath};
use canonform::mesh::InputPoint;
use canonform::settings::Geodesic;
use serde::Serialize;

use super::task::{Task, milliseconds, spelled};
use crate::input::named;
use crate::output::{Answer, Fact, Output, count, shown};

/// Most paths that are printed without `--details`.
const MOST_PATHS: usize = 4;

/// Share by which rounding in faces without area may make a path longer than its distance.
const ROUNDING: f64 = 1e-6;

/// Finds, writes and reports paths.
pub(super) fn write(task: Task<'_>) -> Result<ExitCode> {
    let Task { args, surface, common, .. } = task;
    let fault = |fault| named(&args.mesh, fault);
    // Bad targets fail before any work is done.
    let found = args.path_to.iter().try_for_each(|point| surface.locate(point).map(drop));
    found.map_err(|point| fault(point.into()))?;
    let rows = task.solve()?;
    let start = Instant::now();
    let (mut paths, mut facts) = (Vec::new(), Vec::new());
    let (mesh, budget) = (surface.intrinsic(), task.solver.budget());
    let exact = (args.method != Geodesic::Exact).then(|| Exact::new(mesh, &budget));
    for row in &rows {
        let mut distances = Cow::Borrowed(&row.distances);
        if let Some(solver) = &exact {
            let farthest = args.max_distance.unwrap_or(f64::INFINITY);
            solver.solve_into(&row.sources, farthest, distances.to_mut()).map_err(canonform::Error::from)?;
        }
        let tracer = PathTracer::new(mesh, &row.sources, &distances, &budget);
        for target in &args.path_to {
            let path = SurfacePath::trace(surface, &tracer, &row.from, *target).map_err(fault)?;
            let (source, n_points) = (path.points[0].at, path.points.len());
            let distance = match target {
                InputPoint::Vertex(v) => {
                    let vertex = surface.repaired_vertex(*v).map_err(|point| fault(point.into()))?;
                    Some(row.distances[vertex.index()])
                }
                _ => None,
            };
            facts.push(object! { source, target: *target, length: path.length, distance, n_points });
            paths.push(path);
        }
    }
    let path_seconds = start.elapsed().as_secs_f64();
    write_paths(&task.output, &paths, &facts)?;
    let output = &task.output.name;
    let json = object! {
        method: <&str>::from(args.method),
        n_vertices: surface.n_input_vertices(),
        sources: &args.source,
        targets: &args.path_to,
        outputs: [output],
        paths: &facts,
        seconds: object! {
            load: surface.input.load_seconds,
            setup: task.setup,
            per_source: rows.iter().map(|row| row.seconds).collect::<Vec<_>>(),
        },
        // All paths, on one thread.
        path_seconds,
        repair: &surface.input.report,
    };
    task.output.report(common, &json, |json| {
        let lines: Vec<Fact> = facts
            .iter()
            .map(|path| {
                let ends = format!("{} to {}", spelled(&[path.source]), spelled(&[path.target]));
                let shortest =
                    path.distance.filter(|d| json.method == "exact" && path.length > d * (1.0 + ROUNDING));
                let note =
                    shortest.map_or_else(String::new, |d| format!(", not shortest: {d:.6} are possible"));
                ("path", format!("{ends}: length {:.6}, {} points{note}", path.length, path.n_points))
            })
            .collect();
        let (first, others) = lines.split_at(lines.len().min(MOST_PATHS));
        let details = [
            ("method", json.method.to_owned()),
            ("vertices", json.n_vertices.to_string()),
            ("setup", milliseconds(json.seconds.setup)),
            ("distances", milliseconds(json.seconds.per_source.iter().sum())),
            ("paths", milliseconds(path_seconds)),
        ];
        let answer = Answer {
            sentence: format!("{} holds {}", shown(output), count(facts.len(), "path")),
            facts: first.to_vec(),
            details: [&details[..], others].concat(),
        };
        answer.text(common)
    })
}

fn write_paths(output: &Output, paths: &[SurfacePath], facts: &[impl Serialize]) -> Result<()> {
    match output.format.as_str() {
        "csv" => write_atomically(&output.path, |out| {
            writeln!(out, "path,x,y,z,distance,at")?;
            for (i, path) in paths.iter().enumerate() {
                for PathPoint { at, position: p, distance } in &path.points {
                    writeln!(out, "{i},{},{},{},{distance},{at}", p.x, p.y, p.z)?;
                }
            }
            Ok(())
        })?,
        "json" => {
            let paths = facts.iter().zip(paths).map(|(facts, path)| {
                let points = path.points.iter().map(|point| {
                    let position = <[f64; 3]>::from(point.position);
                    object! { at: point.at, position, distance: point.distance }
                });
                object! {
                    #[serde(flatten)]
                    facts,
                    points: points.collect::<Vec<_>>(),
                }
            });
            let json = object! { paths: paths.collect::<Vec<_>>() };
            write_atomically(&output.path, |out| {
                serde_json::to_writer(&mut *out, &json)?;
                writeln!(out)
            })?;
        }
        _ => {
            let lines: Vec<Vec<_>> =
                paths.iter().map(|path| path.points.iter().map(|point| point.position).collect()).collect();
            canonform::mesh::io::write_polylines(&output.path, &lines)?;
        }
    }
    Ok(())
}
