//! `canonform index verify | info | export`.

use std::collections::BTreeMap;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use canonform::Remedy;
use canonform::index::{ExportFormat, FORMAT_VERSION, Index, Verification};
use canonform::library::export_index;
use serde::Serialize;

use crate::args::Common;
use crate::input::is_stream;
use crate::output::{Answer, Output, count, exit_code, print, print_json, report, shown};
use crate::remedy::with_remedy;

#[derive(Serialize)]
struct VerifyJson<'a> {
    index: &'a Path,
    sound: bool,
    n_shapes: usize,
    n_bytes: u64,
    faults: &'a [String],
}

pub(super) fn verify(index: &Path, common: &Common) -> Result<ExitCode> {
    let Verification { n_shapes, n_bytes, faults } = &canonform::index::verify(index)?;
    let (sound, name) = (faults.is_empty(), shown(index));
    if common.json {
        print_json(&VerifyJson { index, sound, n_shapes: *n_shapes, n_bytes: *n_bytes, faults })?;
    } else if sound {
        print(&format!("{name}: intact, {n_shapes} shapes, {n_bytes} bytes"))?;
    }
    for fault in faults {
        let message = format!("{name} is damaged: {fault}");
        base::terminal::error(&with_remedy(message, Some(Remedy::BuildIndexAgain)));
    }
    Ok(exit_code(sound))
}

#[derive(Serialize)]
struct InfoJson {
    index: PathBuf,
    format: u32,
    n_shapes: usize,
    n_bytes: u64,
    options: serde_json::Value,
    /// Shapes of each class; those without one have an empty key.
    classes: BTreeMap<String, u64>,
    unlabelled: u64,
    /// Whether its writer was interrupted, or is at work.
    unfinished: bool,
}

pub(super) fn info(path: &Path, common: &Common) -> Result<ExitCode> {
    let index = Index::open(path)?;
    let mut classes = index.classes()?;
    let unlabelled = index.len() as u64 - classes.values().sum::<u64>();
    if unlabelled > 0 {
        classes.insert(String::new(), unlabelled);
    }
    let json = InfoJson {
        index: path.to_owned(),
        format: FORMAT_VERSION,
        n_shapes: index.len(),
        n_bytes: index.n_bytes(),
        options: serde_json::from_str(index.options()).unwrap_or_else(|_| index.options().into()),
        unlabelled,
        classes,
        unfinished: !index.is_finished(),
    };
    report(common, &json, |json| answer(json).text(common))
}

/// Most classes that are named without `--details`.
const MOST_CLASSES: usize = 10;

fn answer(json: &InfoJson) -> Answer {
    let classes = json.classes.iter().filter(|(class, _)| !class.is_empty());
    let classes: Vec<String> = classes.map(|(class, n)| format!("{class} {n}")).collect();
    let (index, n_shapes, n_classes) = (json.index.display(), json.n_shapes, classes.len());
    let (first, more) = classes.split_at(n_classes.min(MOST_CLASSES));
    let more = if more.is_empty() { String::new() } else { format!(" and {} more", more.len()) };
    let mut facts = vec![("classes", first.join(", ") + &more)];
    if json.unlabelled > 0 {
        facts.push(("unlabelled", json.unlabelled.to_string()));
    }
    if json.unfinished {
        facts.push(("unfinished", "run the interrupted command again, or wait until it ends".to_owned()));
    }
    Answer {
        sentence: format!("{index} holds {} of {n_classes} classes", count(n_shapes, "shape")),
        facts,
        details: vec![
            ("all classes", classes.join(", ")),
            ("bytes", json.n_bytes.to_string()),
            ("format", json.format.to_string()),
            ("described by", json.options.to_string()),
        ],
    }
}

pub(super) fn export(
    index: &Path,
    output: Option<&Path>,
    format: Option<&str>,
    common: &Common,
) -> Result<ExitCode> {
    let output = output.unwrap_or(Path::new("-"));
    if base::files::is_same_file(index, output) {
        bail!("{} is the index itself; choose another file with -o", output.display());
    }
    let formats = ExportFormat::ALL.map(ExportFormat::extension);
    let is_lines = format.is_none_or(|format| format == ExportFormat::JsonLines.extension());
    let index = Index::open(index)?;
    if is_stream(output) && is_lines {
        let mut out = BufWriter::with_capacity(1 << 16, std::io::stdout().lock());
        index.export(&mut out)?;
        out.flush()?;
        return Ok(ExitCode::SUCCESS);
    }
    let output = Output::new(output, "an index", &formats, format, common)?;
    let format = ExportFormat::named(output.format()).unwrap_or(ExportFormat::JsonLines);
    export_index(&index, format, output.path())?;
    output.copy_to_stdout()?;
    Ok(ExitCode::SUCCESS)
}
