//! `canonform duplicates`.

mod shown;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::{Result, bail};
use base::files::{Scratch, write_bytes};
use base::object;
use base::terminal::Bars;
use canonform::DescribeOptions;
use canonform::collection::{LabelSource, is_dataset};
use canonform::index::{IndexWriter, text_cell};
use canonform::library::{
    DuplicateFile, DuplicateGroup, DuplicateOptions, DuplicateReport, Inputs, ShapeLimits, add_to_index,
    check_place, find_duplicates, move_duplicates, undo_moves,
};
use canonform::mesh::io::is_mesh_path;
use canonform::search::ShapeSearch;

use self::shown::{moved, page, text};
use super::index::skipped;
use crate::args::{Common, DuplicatesArgs, keep_inputs};
use crate::output::{check_output, exit_code, report, word};

/// Finds the files of an index or a dataset that hold one shape, and moves them if asked to.
pub(crate) fn duplicates(args: &DuplicatesArgs, common: &Common) -> Result<ExitCode> {
    if let Some(journal) = &args.undo {
        let undone = undo_moves(journal)?;
        report(common, &undone, moved)?;
        return Ok(exit_code(undone.journal.is_none()));
    }
    args.inputs.iter().filter(|input| input.is_file()).for_each(|input| keep_inputs(input));
    for path in [&args.csv, &args.html].into_iter().flatten() {
        check_output(path, "duplicates", &[])?;
    }
    let index = args.inputs.iter().find(|input| !(is_dataset(input) || is_mesh_path(input)));
    if let (Some(index), true) = (index, args.move_to.is_some() || args.inputs.len() > 1) {
        bail!(
            "{}: an index stands alone, and files are moved out of folders; name the folders of the meshes",
            index.display()
        );
    }
    for (folder, place) in args.inputs.iter().zip(args.move_to.iter().cycle()) {
        check_place(folder, place)?;
    }
    let bars = Bars::new(common.quiet);
    let scratch = Scratch::new()?;
    let search = match index {
        Some(index) => ShapeSearch::open(index)?,
        None => ShapeSearch::open(&described(args, &scratch, &bars)?)?,
    };
    let options = DuplicateOptions {
        kinds: args.kinds.clone(),
        min_confidence: args.min_confidence,
        keep: args.keep.clone(),
        reference: args.reference.clone(),
        folders: args.inputs.iter().filter(|_| index.is_none()).cloned().collect(),
    };
    let mut found = find_duplicates(&search, &options, &bars)?;
    bars.finish();
    let whole = found.clone();
    found.files_mut().for_each(|file| file.path = short(&file.path));
    if let Some(path) = &args.html {
        write_bytes(path, page(&found, &search)?.as_bytes())?;
    }
    if let Some(path) = &args.csv {
        write_bytes(path, csv(&found).as_bytes())?;
    }
    // What can be spared is known before it is moved.
    let told = text(&found);
    let moves =
        args.move_to.as_ref().map(|place| move_duplicates(&whole, &args.inputs, place)).transpose()?;
    let json = object! {
        #[serde(flatten)]
        found,
        #[serde(flatten)]
        moves,
    };
    report(common, &json, |json| {
        told + &json.moves.as_ref().map(|moves| format!("\n\n{}", moved(moves))).unwrap_or_default()
    })?;
    Ok(if json.found.groups.is_empty() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// Builds the index of datasets and meshes.
fn described(args: &DuplicatesArgs, scratch: &Scratch, bars: &Bars) -> Result<PathBuf> {
    let (index, describe) = (scratch.file("all.canonform"), DescribeOptions::default());
    IndexWriter::build(&index, &describe.text())?.finish()?;
    let paths = [&args.inputs[..], &args.reference].concat();
    let inputs = Inputs {
        paths: &paths,
        labels: Some(&LabelSource::None),
        label: None,
        limits: ShapeLimits::default(),
    };
    let built = add_to_index(&index, &inputs, false, bars)?;
    skipped(&built).iter().for_each(|note| base::terminal::note(note));
    for failure in &built.failed {
        base::terminal::note(&format!("left out {}: {}", failure.path.display(), failure.error));
    }
    if built.n_shapes == 0 && !built.failed.is_empty() {
        bail!("none of the {} meshes can be used; the notes above say why", built.failed.len());
    }
    Ok(index)
}

/// The path below the current folder, if it lies there. A link is not followed: its own name is meant.
fn short(path: &Path) -> PathBuf {
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    here.ok().and_then(|here| path.strip_prefix(here).ok().map(Path::to_owned)).unwrap_or(path.to_owned())
}

/// One line per file, keepers first.
fn csv(report: &DuplicateReport) -> String {
    let mut text = "group,role,id,path,kind,confidence,relation,bytes,modified\n".to_owned();
    for (i, DuplicateGroup { keeper, why, members }) in report.groups.iter().enumerate() {
        let mut line = |role: &str, file: &DuplicateFile, kind: &str, confidence: &str, words: &str| {
            let number = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
            let (id, path) = (text_cell(&file.id), text_cell(&file.path.display().to_string()));
            let (words, bytes, modified) = (text_cell(words), number(file.bytes), number(file.modified));
            let group = i + 1;
            text += &format!("{group},{role},{id},{path},{kind},{confidence},{words},{bytes},{modified}\n");
        };
        line("keep", keeper, "", "", why);
        for member in members {
            let told = &member.relation;
            let (kind, confidence) = (word(told.kind), format!("{:.3}", told.confidence));
            let role = match (member.file.reference, member.is_spare()) {
                (true, _) => "reference",
                (false, true) => "spare",
                (false, false) => "related",
            };
            line(role, &member.file, &kind, &confidence, &told.to_string());
        }
    }
    text
}
