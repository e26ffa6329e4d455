//! Shortest paths from sources to targets.

use std::io::{self, Write};
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use canonform::Surface;
use canonform::geodesics::{PathTracer, Source, SurfacePath};
use canonform::mesh::{InputPoint, RepairReport};
use serde::Serialize;

use super::task::{Row, Seconds, Task, spelled};
use crate::input::named;
use crate::output::{Answer, Output, count, shown};

/// Most paths that are printed without `--details`.
const MOST_PATHS: usize = 4;

/// Share by which rounding in faces without area may make a path longer than its distance.
const ROUNDING: f64 = 1e-6;

#[derive(Serialize)]
struct PathsJson {
    method: &'static str,
    n_vertices: usize,
    sources: Vec<InputPoint>,
    targets: Vec<InputPoint>,
    outputs: Vec<PathBuf>,
    paths: Vec<PathFacts>,
    seconds: Seconds,
    /// All paths, on one thread.
    path_seconds: f64,
    repair: RepairReport,
}

#[derive(Serialize)]
struct PathFacts {
    /// The start: the nearest source.
    source: InputPoint,
    target: InputPoint,
    length: f64,
    /// The distance by the method, for a target that is a vertex.
    distance: Option<f64>,
    n_points: usize,
}

/// Finds, writes and reports paths.
pub(super) fn write(task: Task<'_>) -> Result<ExitCode> {
    let Task { args, surface, .. } = task;
    let fault = |fault| named(&args.mesh, fault);
    // Bad targets fail before any work is done.
    let targets: Result<Vec<_>, _> = args.path_to.iter().map(|point| surface.locate(point)).collect();
    let targets = targets.map_err(|point| fault(point.into()))?;
    let (rows, seconds) = task.solve()?;
    let start = Instant::now();
    let (mut paths, mut facts) = (Vec::new(), Vec::new());
    for row in &rows {
        let tracer =
            PathTracer::new(surface.intrinsic(), &row.sources, &row.distances, &task.solver.budget());
        for (target, at) in args.path_to.iter().zip(&targets) {
            let mut path = SurfacePath::trace(surface, &tracer, *at).map_err(fault)?;
            // The ends as the user wrote them.
            let source = source_of(&path, row, surface).unwrap_or(*target);
            let n = path.points.len();
            path.points[0].at = source;
            path.points[n - 1].at = *target;
            let distance = match target {
                InputPoint::Vertex(v) => Some(
                    row.distances[surface.repaired_vertex(*v).map_err(|point| fault(point.into()))?.index()],
                ),
                _ => None,
            };
            let (length, n_points) = (path.length, path.points.len());
            facts.push(PathFacts { source, target: *target, length, distance, n_points });
            paths.push(path);
        }
    }
    let path_seconds = start.elapsed().as_secs_f64();
    write_paths(&task.output, &paths, &facts)?;
    let json = PathsJson {
        method: args.method.into(),
        n_vertices: surface.n_input_vertices(),
        sources: args.source.clone(),
        targets: args.path_to.clone(),
        outputs: vec![task.output.name()],
        paths: facts,
        seconds,
        path_seconds,
        repair: surface.input.report.clone(),
    };
    let common = task.common;
    task.output.report(common, &json, |json| answer(json).text(common))
}

/// The source where a path starts.
fn source_of(path: &SurfacePath, row: &Row, surface: &Surface) -> Option<InputPoint> {
    let start = path.points.first()?.position;
    let away = |source: &Source| (surface.position(source.point()) - start).norm();
    let all = row.from.iter().zip(&row.sources);
    all.min_by(|(_, a), (_, b)| away(a).total_cmp(&away(b))).map(|(from, _)| *from)
}

fn answer(json: &PathsJson) -> Answer {
    let outputs: Vec<String> = json.outputs.iter().map(|path| shown(path)).collect();
    let path = |path: &PathFacts| {
        let ends = format!("{} to {}", spelled(&[path.source]), spelled(&[path.target]));
        let shortest = path.distance.filter(|d| json.method == "exact" && path.length > d * (1.0 + ROUNDING));
        let note = shortest.map_or_else(String::new, |d| format!(", not shortest: {d:.6} are possible"));
        ("path", format!("{ends}: length {:.6}, {} points{note}", path.length, path.n_points))
    };
    let milliseconds = |seconds: f64| format!("{:.2} ms", 1e3 * seconds);
    let (first, others) = json.paths.split_at(json.paths.len().min(MOST_PATHS));
    let details = [
        ("method", json.method.to_owned()),
        ("vertices", json.n_vertices.to_string()),
        ("setup", milliseconds(json.seconds.setup)),
        ("distances", milliseconds(json.seconds.per_source.iter().sum())),
        ("paths", milliseconds(json.path_seconds)),
    ];
    Answer {
        sentence: format!("{} holds {}", outputs.join(", "), count(json.paths.len(), "path")),
        facts: first.iter().map(path).collect(),
        details: details.into_iter().chain(others.iter().map(path)).collect(),
    }
}

fn write_paths(output: &Output, paths: &[SurfacePath], facts: &[PathFacts]) -> Result<()> {
    let path = output.path();
    match output.format() {
        "csv" => base::files::write_atomically(path, |out| write_csv(out, paths))?,
        "json" => base::files::write_atomically(path, |out| write_json(out, paths, facts))?,
        _ => {
            let lines: Vec<Vec<_>> =
                paths.iter().map(|path| path.points.iter().map(|point| point.position).collect()).collect();
            canonform::mesh::io::write_polylines(path, &lines)?;
        }
    }
    Ok(())
}

/// One line per point.
fn write_csv(out: &mut dyn Write, paths: &[SurfacePath]) -> io::Result<()> {
    writeln!(out, "path,x,y,z,distance,at")?;
    for (i, path) in paths.iter().enumerate() {
        for point in &path.points {
            let [x, y, z] = point.position.into();
            writeln!(out, "{i},{x},{y},{z},{},{}", point.distance, point.at)?;
        }
    }
    Ok(())
}

/// One object with the facts and the points of each path.
fn write_json(out: &mut dyn Write, paths: &[SurfacePath], facts: &[PathFacts]) -> io::Result<()> {
    #[derive(Serialize)]
    struct Point {
        at: InputPoint,
        position: [f64; 3],
        distance: f64,
    }
    #[derive(Serialize)]
    struct Path<'a> {
        #[serde(flatten)]
        facts: &'a PathFacts,
        points: Vec<Point>,
    }
    #[derive(Serialize)]
    struct File<'a> {
        paths: Vec<Path<'a>>,
    }
    let points = |path: &SurfacePath| {
        let point = |p: &canonform::geodesics::PathPoint| Point {
            at: p.at,
            position: p.position.into(),
            distance: p.distance,
        };
        path.points.iter().map(point).collect()
    };
    let paths = paths.iter().zip(facts).map(|(path, facts)| Path { facts, points: points(path) }).collect();
    serde_json::to_writer(&mut *out, &File { paths })?;
    writeln!(out)
}
