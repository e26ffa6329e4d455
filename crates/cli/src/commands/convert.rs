//! `canonform convert`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use base::object;
use canonform::mesh::RepairReport;
use canonform::mesh::io::{Content, FileFacts, Format, LengthUnit, MeshFile, extension, or_list, writable};
use serde::Serialize;

use crate::args::{Common, ConvertArgs};
use crate::batch::Results;
use crate::input::{check_there, file_name, is_single, is_stream, named, print_repair, read_file};
use crate::output::{Output, exit_code, report, shown};

#[derive(Serialize)]
struct Json {
    input: PathBuf,
    output: PathBuf,
    n_vertices: usize,
    n_faces: usize,
    /// What the input says beside the mesh.
    file: FileFacts,
    /// How the mesh was repaired, with `--repair`.
    repair: Option<RepairReport>,
}

/// Converts one mesh, or each of several.
pub(crate) fn convert(args: &ConvertArgs, common: &Common) -> Result<ExitCode> {
    let inputs = std::slice::from_ref(&args.input);
    if is_single(inputs, &args.output) { one(args, common) } else { batch(args, common) }
}

fn one(args: &ConvertArgs, common: &Common) -> Result<ExitCode> {
    check_there(&args.input)?;
    if is_stream(&args.output) && args.output_format.is_none() {
        bail!("standard output has no file name: pass its format, such as --output-format ply");
    }
    let is_one_file =
        |format: &&str| Format::named(format).is_some_and(|format| format.extensions.len() == 1);
    let formats: Vec<&str> = match is_stream(&args.output) {
        true => writable(Content::Mesh).filter(is_one_file).collect(),
        // Either half of a pair names both.
        false => writable(Content::Mesh).chain(["tri"]).collect(),
    };
    let output = Output::new(&args.output, "a mesh", &formats, args.output_format.as_deref(), common)?;
    let result = write(&args.input, &output.path, args, common)?;
    let json = Json { output: output.name.clone(), ..result };
    notes(&json, args);
    output.report(common, &json, sentence)
}

/// Reads, repairs and writes a mesh.
fn write(input: &Path, output: &Path, args: &ConvertArgs, common: &Common) -> Result<Json> {
    let MeshFile { mesh, facts: file, .. } = read_file(input, common)?;
    // Few formats hold points without faces.
    let (mesh, repair) = match args.repair || mesh.faces.is_empty() {
        false => (mesh, None),
        true => {
            let repaired = canonform::mesh::repair(&mesh, &args.repair_options.options(), &());
            let repaired = repaired.map_err(|fault| named(input, fault.into()))?;
            (repaired.mesh, Some(repaired.report))
        }
    };
    let (n_vertices, n_faces) = (mesh.n_vertices(), mesh.n_faces());
    canonform::mesh::io::write(output, &mesh)?;
    Ok(Json { input: input.to_owned(), output: output.to_owned(), n_vertices, n_faces, file, repair })
}

/// Says what was repaired and what the output does not say.
fn notes(json: &Json, args: &ConvertArgs) {
    let name = file_name(&json.input);
    if let Some(report) = &json.repair {
        print_repair(&name, report, &args.repair_options);
    }
    for what in &json.file.ignored {
        base::terminal::note(&format!("{name}: ignored {what}"));
    }
    json.file.notes.iter().for_each(|note| base::terminal::note(&format!("{name}: {note}")));
    let is_3mf = extension(&json.output) == "3mf" || args.output_format.as_deref() == Some("3mf");
    let kept = is_3mf && json.file.unit == Some(LengthUnit::Millimeter);
    if let Some(unit) = json.file.unit.filter(|_| !kept) {
        let says = if is_3mf { "states millimeter" } else { "does not state it" };
        base::terminal::note(&format!(
            "{name}: the unit of its coordinates is the {}, and the output {says}",
            unit.name()
        ));
    }
}

/// Converts meshes in parallel. Failures are listed at the end and do not stop the rest.
fn batch(args: &ConvertArgs, common: &Common) -> Result<ExitCode> {
    let formats: Vec<&str> = writable(Content::Mesh).collect();
    let Some(extension) = args.output_format.as_deref().map(|format| format.trim_start_matches('.')) else {
        bail!("pass the format of the meshes in the folder, such as --output-format ply");
    };
    if !formats.contains(&extension.trim_end_matches(".gz")) {
        bail!("meshes cannot be written as {extension}; use {}", or_list(formats));
    }
    let (arguments, folder) = (std::slice::from_ref(&args.input), &args.output);
    let results = Results { what: "meshes", arguments, folder, extension, in_parallel: true };
    let (done, failed) = results.make(common, |shape, output| write(&shape.path, output, args, common))?;
    let meshes: Vec<Json> = done.into_iter().map(|(_, json)| json).collect();
    meshes.iter().for_each(|json| notes(json, args));
    let json = object! { meshes, failed };
    report(common, &json, |json| results.counts(json.meshes.len(), &json.failed))?;
    Ok(exit_code(json.failed.is_empty()))
}

fn sentence(json: &Json) -> String {
    format!("{} holds {} vertices and {} faces", shown(&json.output), json.n_vertices, json.n_faces)
}
