//! `canonform embed`.

use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use canonform::linalg::Matrix;
use canonform::{
    Budget, EmbedMethod, EmbedReport, FormOptions, InputMap, StressOptions, Surface, embed_and_release,
};
use mesh::io::{extension, or_list};
use rayon::prelude::*;
use serde::Serialize;
use surface::VertexId;

use crate::args::{Common, EmbedArgs, FORM_FORMATS, LimitArgs};
use crate::input::{
    create_folder_of, expand, is_single, is_stream, named, outputs, print_repair, read_both, read_surface,
};
use crate::output::{Output, exit_code, facts, fill_npy, report};
use terminal::Bars;

#[derive(Serialize)]
struct EmbedJson {
    #[serde(flatten)]
    report: EmbedReport,
    output: PathBuf,
}

#[derive(Serialize)]
struct BatchJson {
    shapes: Vec<ShapeJson>,
    failed: Vec<Failure>,
}

#[derive(Serialize)]
struct ShapeJson {
    name: String,
    label: String,
    path: PathBuf,
    #[serde(flatten)]
    result: EmbedJson,
}

#[derive(Serialize)]
struct Failure {
    name: String,
    path: PathBuf,
    error: String,
}

/// Embeds one mesh, or each of several.
pub(crate) fn embed(args: &EmbedArgs, common: &Common) -> Result<ExitCode> {
    let options = args.embedding.options(common)?;
    let against = args.stress_against.map(|method| args.embedding.form.marching.of(method));
    let stress = StressOptions { choice: args.stress, against, seed: common.seed };
    if args.embedding.form.samples.is_some() && options.method == EmbedMethod::Classical {
        terminal::note("note: -n has no effect with --method mds, which measures all pairs of vertices");
    }
    match &args.meshes[..] {
        [mesh] if is_single(&args.meshes) => one(mesh, args, &options, &stress, common),
        _ => batch(args, &options, &stress, common),
    }
}

fn one(
    mesh: &Path,
    args: &EmbedArgs,
    options: &FormOptions,
    stress: &StressOptions,
    common: &Common,
) -> Result<ExitCode> {
    let formats = FORM_FORMATS.map(|(extension, _)| extension);
    let output = Output::new(&args.output, "a form", &formats, Some(output_format(args, common)?), common)?;
    check_dim(output.path(), options.dim)?;
    let surface = read_surface(mesh, &args.embedding.form.repair, common)?;
    let bars = Bars::with_budget(common.quiet, budget(args, output.path(), 1));
    let report = embed_and_write(mesh, surface, output.path(), options, stress, &bars)?;
    drop(bars);
    warn(&mesh.display().to_string(), &report);
    let json = EmbedJson { report, output: output.name() };
    output.report(common, &json, table)
}

/// The limits of an embedding, one of `n_at_once`. Distances that do not fit into memory are kept in a file beside the form.
///
/// Under `ulimit -v` they have their share of three quarters of that memory; the rest is for the program itself.
fn budget(args: &EmbedArgs, output: &Path, n_at_once: usize) -> Budget {
    let share = || Some(terminal::memory_limit()? / 4 * 3 / n_at_once);
    let limits = LimitArgs { memory: args.limits.memory.or_else(share), ..args.limits };
    let folder = output.ancestors().skip(1).find(|folder| folder.is_dir()).unwrap_or(Path::new("."));
    limits.budget().with_spill(folder.to_owned())
}

/// Embeds a surface and writes its form.
fn embed_and_write(
    mesh: &Path,
    mut surface: Surface,
    output: &Path,
    options: &FormOptions,
    stress: &StressOptions,
    bars: &Bars,
) -> Result<EmbedReport> {
    if extension(output) == "npy" {
        // Only meshes need them.
        surface.input_faces = Vec::new();
    }
    let (embedded, map) =
        embed_and_release(surface, options, stress, bars).map_err(|fault| named(mesh, fault))?;
    create_folder_of(output)?;
    write(output, &map, &embedded.embedding.coords)?;
    Ok(embedded.report)
}

/// The format of forms in a folder or on standard output.
fn output_format(args: &EmbedArgs, common: &Common) -> Result<&'static str> {
    let Some(stated) = common.format_of_output(args.meshes.iter().any(|mesh| is_stream(mesh))) else {
        return Ok(args.output_format.unwrap_or("ply"));
    };
    let known = FORM_FORMATS.map(|(extension, _)| extension);
    match (args.output_format, known.into_iter().find(|extension| *extension == stated)) {
        (Some(given), _) => Ok(given),
        (None, Some(stated)) => Ok(stated),
        (None, None) => bail!("forms cannot be written as {stated}; use {}", or_list(known)),
    }
}

/// Embeds meshes in parallel. Failures are listed at the end and do not stop the rest.
fn batch(
    args: &EmbedArgs,
    options: &FormOptions,
    stress: &StressOptions,
    common: &Common,
) -> Result<ExitCode> {
    let extension = output_format(args, common)?;
    if is_stream(&args.output) {
        bail!("several forms cannot go to standard output; name a folder with -o");
    }
    check_dim(Path::new(&format!("form.{extension}")), options.dim)?;
    let shapes = expand(&args.meshes)?;
    let outputs = outputs(&shapes, &args.output, extension)?;
    let bar = Bars::new(common.quiet).bar("shapes", shapes.len());
    let results: Vec<Result<EmbedJson>> = shapes
        .par_iter()
        .zip(outputs)
        .map(|(shape, output)| {
            let one = || {
                let (_, surface) = read_both(&shape.path, &args.embedding.form.repair, common)?;
                let bars = Bars::with_budget(true, budget(args, &output, rayon::current_num_threads()));
                let report = embed_and_write(&shape.path, surface, &output, options, stress, &bars)?;
                Ok(EmbedJson { report, output: output.clone() })
            };
            let result = one();
            bar.inc(1);
            result
        })
        .collect();
    bar.finish_and_clear();

    let mut json = BatchJson { shapes: Vec::new(), failed: Vec::new() };
    for (shape, result) in shapes.into_iter().zip(results) {
        let (name, path) = (shape.name, shape.path);
        match result {
            Ok(result) => {
                print_repair(&name, &result.report.repair, &args.embedding.form.repair);
                warn(&name, &result.report);
                json.shapes.push(ShapeJson { name, label: shape.label, path, result });
            }
            Err(fault) => {
                json.failed.push(Failure { name, path, error: crate::remedy::message(&fault) });
            }
        }
    }
    for failure in &json.failed {
        terminal::error(&failure.error);
    }
    report(common, &json, |json| batch_table(json, &args.output))?;
    Ok(exit_code(json.failed.is_empty()))
}

/// Refuses a form whose file cannot hold this many dimensions, before any work is done.
fn check_dim(output: &Path, dim: usize) -> Result<()> {
    if extension(output) != "npy" && dim != 3 {
        bail!("{}: a mesh has 3 dimensions, not {dim}; write .npy or leave out --dim", output.display());
    }
    Ok(())
}

/// Writes the form: an array with one row per input vertex, or a mesh with the faces of the repaired input.
fn write(output: &Path, map: &InputMap, coords: &Matrix) -> Result<()> {
    if extension(output) == "npy" {
        let shape = [map.n_input_vertices(), coords.ncols()];
        return fill_npy(output, shape, |file| {
            let mut out = BufWriter::with_capacity(1 << 16, file);
            for vertex in 0..map.n_input_vertices() {
                let vertex = map.repaired_vertex(VertexId::from(vertex));
                for column in coords.column_iter() {
                    let value = vertex.map_or(f64::NAN, |v| column[v.index()]);
                    out.write_all(&value.to_le_bytes())?;
                }
            }
            out.flush()
        });
    }
    let position = |v: VertexId| [0, 1, 2].map(|axis| coords[(v.index(), axis)]).into();
    Ok(mesh::io::write(output, &map.with_positions(position))?)
}

/// Warns about dimensions without a positive eigenvalue.
fn warn(name: &str, report: &EmbedReport) {
    if report.empty_dimensions > 0 {
        terminal::note(&format!(
            "{name}: {} of {} dimensions have no positive eigenvalue and are zero; take more samples with -n",
            report.empty_dimensions, report.dim
        ));
    }
}

fn stress_text(report: &EmbedReport) -> String {
    match &report.stress {
        None => "-".to_owned(),
        Some(s) if s.interval[0] == s.interval[1] => format!("{:.6}", s.value),
        Some(s) => {
            let [low, high] = s.interval;
            format!("{:.6} (95 %: {low:.6} to {high:.6}, from {} rows)", s.value, s.rows)
        }
    }
}

fn normalized_text(report: &EmbedReport) -> String {
    report.stress.as_ref().map_or_else(|| "-".to_owned(), |s| format!("{:.4}", s.normalized))
}

/// The method and its options.
fn method_text(report: &EmbedReport) -> String {
    let regularization = report.regularization.map_or(String::new(), |name| format!(" ({name})"));
    let sampling = report.sampling.map_or(String::new(), |name| format!(", {name} samples"));
    let descent = report
        .descent
        .as_ref()
        .map_or(String::new(), |descent| format!(", {} steps ({})", descent.iterations, descent.stop));
    format!("{}{regularization} on {} distances{sampling}{descent}", report.method, report.geodesic)
}

fn table(json: &EmbedJson) -> String {
    let r = &json.report;
    let eigenvalues: Vec<String> = r.eigenvalues.iter().take(r.dim).map(|v| format!("{v:.5e}")).collect();
    facts(&[
        ("method", method_text(r)),
        ("vertices, faces", format!("{}, {}", r.n_vertices, r.n_faces)),
        ("samples, rank", format!("{}, {}", r.n_samples, r.rank)),
        ("eigenvalues", eigenvalues.join(" ")),
        ("negative mass", format!("{:.4}", r.negative_mass)),
        ("stress", stress_text(r)),
        ("normalised stress", normalized_text(r)),
        (
            "seconds",
            format!(
                "{:.3} (distances {:.3}, embedding {:.3}) + stress {:.3}",
                r.seconds.total, r.seconds.geodesics, r.seconds.embedding, r.seconds.stress
            ),
        ),
        ("wrote", json.output.display().to_string()),
    ])
}

fn batch_table(json: &BatchJson, folder: &Path) -> String {
    let mut table = comfy_table::Table::new();
    table.load_style(comfy_table::presets::NOTHING).set_header([
        "shape",
        "class",
        "vertices",
        "samples",
        "stress",
        "normalised stress",
        "seconds",
    ]);
    for shape in &json.shapes {
        let r = &shape.result.report;
        table.add_row([
            shape.name.clone(),
            shape.label.clone(),
            r.n_embedded.to_string(),
            r.n_samples.to_string(),
            stress_text(r),
            normalized_text(r),
            format!("{:.3}", r.seconds.total),
        ]);
    }
    let counts = format!("{} forms in {}, {} failed", json.shapes.len(), folder.display(), json.failed.len());
    format!("{table}\n{counts}")
}
