//! `canonform geodesic`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context, Result, bail};
use mesh::{RepairReport, TriMesh, VertexId};
use pipeline::Surface;
use serde::Serialize;

use super::{named, read_surface};
use crate::args::{Common, GeodesicArgs};
use crate::output::{check_folder, extension, facts, print, print_json, write_csv, write_npy};
use terminal::Bars;

#[derive(Serialize)]
struct GeodesicJson {
    method: &'static str,
    n_vertices: usize,
    sources: Vec<u32>,
    outputs: Vec<PathBuf>,
    /// Largest distance from each source, over the vertices reached.
    farthest: Vec<f64>,
    seconds: Seconds,
    /// Input vertices without a way from the sources.
    unreached: Vec<u32>,
    repair: RepairReport,
}

#[derive(Serialize)]
struct Seconds {
    load: f64,
    setup: f64,
    per_source: Vec<f64>,
}

/// Measures distances and writes one row, or one coloured mesh, a source.
pub(crate) fn geodesic(args: &GeodesicArgs, common: &Common) -> Result<ExitCode> {
    let format = extension(&args.output);
    if !["npy", "csv", "ply"].contains(&format.as_str()) {
        bail!(
            "{}: distances are written as .npy, .csv or .ply; end the name in one of them",
            args.output.display()
        );
    }
    check_folder(&args.output)?;
    let surface = read_surface(&args.mesh, &args.repair)?;
    let sources = args
        .source
        .iter()
        .map(|&v| surface.repaired_vertex(VertexId(v)))
        .collect::<Result<Vec<_>, _>>()
        .map_err(|fault| named(&args.mesh, fault))?;

    let method = args.method.method(args.marching);
    let start = Instant::now();
    let solver = method.prepare(&surface.intrinsic).map_err(|fault| named(&args.mesh, fault.into()))?;
    let setup = surface.repair_seconds + start.elapsed().as_secs_f64();
    let bars = Bars::new(common.quiet);
    let bar = bars.bar("distances", sources.len());
    let mut rows = Vec::with_capacity(sources.len());
    let mut per_source = Vec::with_capacity(sources.len());
    for source in sources {
        let mut row = vec![0.0; solver.n_vertices()];
        let start = Instant::now();
        solver.distances_into(source, &mut row);
        per_source.push(start.elapsed().as_secs_f64());
        rows.push(surface.in_input_order(&row, f64::INFINITY));
        bar.inc(1);
    }
    bar.finish_and_clear();

    let outputs = write(&args.output, &format, &surface, &args.mesh, &args.source, &rows)?;
    let unreached = (0..surface.n_input_vertices() as u32)
        .filter(|&v| rows.iter().any(|row| !row[v as usize].is_finite()))
        .collect();
    let farthest =
        rows.iter().map(|row| row.iter().copied().filter(|d| d.is_finite()).fold(0.0, f64::max)).collect();
    let json = GeodesicJson {
        method: method.name(),
        n_vertices: surface.n_input_vertices(),
        sources: args.source.clone(),
        outputs,
        farthest,
        seconds: Seconds { load: surface.load_seconds, setup, per_source },
        unreached,
        repair: surface.repaired.report,
    };
    if common.json {
        print_json(&json)?
    } else {
        print(&table(&json))?
    }
    Ok(ExitCode::SUCCESS)
}

fn table(json: &GeodesicJson) -> String {
    let mut rows = vec![
        ("method", json.method.to_owned()),
        ("vertices", json.n_vertices.to_string()),
        ("setup", format!("{:.1} ms", 1e3 * json.seconds.setup)),
    ];
    for (i, source) in json.sources.iter().enumerate() {
        let [farthest, ms] = [json.farthest[i], 1e3 * json.seconds.per_source[i]];
        rows.push(("source", format!("{source}: farthest {farthest:.6}, {ms:.2} ms")));
    }
    if !json.unreached.is_empty() {
        rows.push(("unreached", format!("{} vertices, written as inf", json.unreached.len())));
    }
    rows.extend(json.outputs.iter().map(|path| ("wrote", path.display().to_string())));
    facts(&rows)
}

/// Writes the distances, in the input's order of vertices, and returns the files.
fn write(
    output: &Path,
    format: &str,
    surface: &Surface,
    input: &Path,
    sources: &[u32],
    rows: &[Vec<f64>],
) -> Result<Vec<PathBuf>> {
    let slices = rows.iter().map(Vec::as_slice);
    match format {
        "npy" => write_npy(output, surface.n_input_vertices(), slices)?,
        "csv" => write_csv(output, slices)?,
        _ => {
            let mesh: TriMesh = mesh::io::read(input)?;
            let mut outputs = Vec::new();
            for (source, row) in sources.iter().zip(rows) {
                let path = if sources.len() == 1 { output.to_owned() } else { numbered(output, *source) };
                mesh::io::write_scalar_field(&path, &mesh, row, "distance")
                    .with_context(|| format!("source {source}"))?;
                outputs.push(path);
            }
            return Ok(outputs);
        }
    }
    Ok(vec![output.to_owned()])
}

/// `out.ply` for source 7 of several: `out-7.ply`.
fn numbered(output: &Path, source: u32) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    output.with_file_name(format!("{stem}-{source}.ply"))
}
