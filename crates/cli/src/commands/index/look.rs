//! `canonform index verify | info | export | list`.

use std::io::{BufWriter, Write};
use std::path::Path;
use std::process::ExitCode;

use anyhow::{Result, bail};
use base::object;
use canonform::Remedy;
use canonform::index::{Entry, ExportFormat, FORMAT_VERSION, Index, Verification};
use canonform::library::{export_index, mesh_path};
use serde_json::Value;

use crate::args::{Common, ListArgs};
use crate::input::is_stream;
use crate::output::{Answer, Output, count, exit_code, print, print_json, report, row_of, shown, table_of};
use crate::remedy::with_remedy;

pub(super) fn verify(index: &Path, common: &Common) -> Result<ExitCode> {
    let Verification { n_shapes, n_bytes, faults } = canonform::index::verify(index)?;
    let (sound, name) = (faults.is_empty(), shown(index));
    if common.json {
        print_json(&object! { index, sound, n_shapes, n_bytes, faults: &faults })?;
    } else if sound {
        print(&format!("{name}: intact, {}, {n_bytes} bytes", count(n_shapes, "shape")))?;
    }
    for fault in faults {
        let message = format!("{name} is damaged: {fault}");
        base::terminal::error(&with_remedy(message, Some(Remedy::BuildIndexAgain)));
    }
    Ok(exit_code(sound))
}

/// Most classes that are named without `--details`.
const MOST_CLASSES: usize = 10;

pub(super) fn info(path: &Path, common: &Common) -> Result<ExitCode> {
    let index = Index::open(path)?;
    let (mut classes, n_shapes) = (index.classes()?, index.len());
    let named: Vec<String> = classes.iter().map(|(class, n)| format!("{class} {n}")).collect();
    let unlabelled = n_shapes as u64 - classes.values().sum::<u64>();
    if unlabelled > 0 {
        classes.insert(String::new(), unlabelled);
    }
    let json = object! {
        index: path,
        format: FORMAT_VERSION,
        n_shapes,
        n_bytes: index.n_bytes(),
        options: serde_json::from_str(&index.options).unwrap_or_else(|_| Value::from(index.options.as_str())),
        // Shapes of each class; those without one have an empty key.
        classes,
        unlabelled,
        // Whether its writer was interrupted, or is at work.
        unfinished: !index.is_finished,
    };
    report(common, &json, |json| {
        let (first, more) = named.split_at(named.len().min(MOST_CLASSES));
        let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
        let mut facts = Vec::new();
        facts.extend((!named.is_empty()).then(|| ("classes", first.join(", ") + &more)));
        facts.extend((unlabelled > 0).then(|| ("unlabelled", unlabelled.to_string())));
        let unfinished = "run the interrupted command again, or wait until it ends";
        facts.extend(json.unfinished.then(|| ("unfinished", unfinished.to_owned())));
        let (index, shapes) = (path.display(), count(n_shapes, "shape"));
        let answer = Answer {
            sentence: format!("{index} holds {shapes} of {}", count(named.len(), "class")),
            facts,
            details: vec![
                ("all classes", named.join(", ")),
                ("bytes", json.n_bytes.to_string()),
                ("format", json.format.to_string()),
                ("described by", json.options.to_string()),
            ],
        };
        answer.text(common)
    })
}

pub(super) fn export(
    path: &Path,
    output: Option<&Path>,
    format: Option<&str>,
    common: &Common,
) -> Result<ExitCode> {
    let output = output.unwrap_or(Path::new("-"));
    if base::files::is_same_file(path, output) {
        bail!("{} is the index itself; choose another file with -o", output.display());
    }
    let formats = ExportFormat::ALL.map(ExportFormat::extension);
    let is_lines = format.is_none_or(|format| format == ExportFormat::JsonLines.extension());
    let index = Index::open(path)?;
    if is_stream(output) && is_lines && !common.json {
        let mut out = BufWriter::with_capacity(1 << 16, std::io::stdout().lock());
        index.export(&mut out)?;
        out.flush()?;
        return Ok(ExitCode::SUCCESS);
    }
    let output = Output::new(output, "an index", &formats, format, common)?;
    let format = ExportFormat::named(&output.format).unwrap_or(ExportFormat::JsonLines);
    export_index(&index, format, &output.path)?;
    if common.json {
        print_json(&object! { index: path, output: &output.name, n_shapes: index.len() })?;
    }
    output.copy_to_stdout()?;
    Ok(ExitCode::SUCCESS)
}

pub(super) fn list(args: &ListArgs, common: &Common) -> Result<ExitCode> {
    let index = Index::open(&args.index)?;
    let lists_all = args.label.is_empty() && !args.unlabelled;
    let is_listed =
        |label: &String| lists_all || args.label.contains(label) || args.unlabelled && label.is_empty();
    let entries = index.entries()?.into_iter().filter(|entry| is_listed(&entry.label));
    let shapes = entries.map(|Entry { id, label, path, facts, .. }| {
        let path = mesh_path(&args.index, &path).to_string_lossy().into_owned();
        object! { id, label, path, vertices: facts.vertices, faces: facts.faces }
    });
    let json = object! { index: &args.index, n_shapes: index.len(), shapes: shapes.collect::<Vec<_>>() };
    let code = report(common, &json, |json| {
        let mut table = table_of(["shape", "class", "vertices", "path"]);
        for shape in &json.shapes {
            let class = if shape.label.is_empty() { "-" } else { &shape.label };
            table.add_row(row_of([&shape.id, class, &shape.vertices.to_string(), &shape.path]));
        }
        let counts = format!("{} of {} shapes in {}", json.shapes.len(), json.n_shapes, shown(json.index));
        format!("{table}\n  {counts}")
    })?;
    Ok(if json.shapes.is_empty() { ExitCode::from(1) } else { code })
}
