//! `canonform index build | add | remove | merge`.

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use canonform::{
    BuildOptions, BuildReport, Inputs, LabelFile, MergeReport, add_to_index, build_index, merge_indexes,
    remove_from_index,
};
use serde::Serialize;
use terminal::Bars;

use crate::args::{AddArgs, BuildArgs, Common, MAX_DROPPED};
use crate::input::{check_dropped, is_named};
use crate::output::{check_folder, exit_code, facts, report};
use crate::remedy::with_remedy;

#[derive(Serialize)]
struct Json<T: Serialize> {
    index: PathBuf,
    #[serde(flatten)]
    report: T,
}

pub(super) fn build(args: &BuildArgs, common: &Common) -> Result<ExitCode> {
    check_folder(&args.output)?;
    let labels = args.labels.as_deref().map(LabelFile::read).transpose()?;
    let describe = args.describe.options(common)?;
    let options = BuildOptions { describe: &describe, labels: labels.as_ref(), shard: args.shard };
    let built = build_index(&args.folder, &args.output, &options, &Bars::new(common.quiet))?;
    summarize(&args.output, built, args.describe.embedding.form.repair.max_dropped, common)
}

pub(super) fn add(args: &AddArgs, common: &Common) -> Result<ExitCode> {
    let labels = args.labels.as_deref().map(LabelFile::read).transpose()?;
    let inputs = Inputs { paths: &args.meshes, labels: labels.as_ref(), label: args.label.as_deref() };
    let added = add_to_index(&args.index, &inputs, args.replace, &Bars::new(common.quiet))?;
    summarize(&args.index, added, MAX_DROPPED, common)
}

/// Prints what happened to the meshes, those that lost more of their surface than allowed and failures last.
fn summarize(index: &Path, built: BuildReport, max_dropped: f64, common: &Common) -> Result<ExitCode> {
    let json = Json { index: index.to_owned(), report: built };
    report(common, &json, |json| table(index, &json.report, max_dropped))?;
    for shape in &json.report.dropped {
        check_dropped(&shape.id, shape.dropped_area_share, max_dropped);
    }
    for failure in &json.report.failed {
        let message = match is_named(&failure.path, &failure.error) {
            true => failure.error.clone(),
            false => format!("{}: {}", failure.path.display(), failure.error),
        };
        eprintln!("error: {}", with_remedy(message, failure.remedy));
    }
    Ok(exit_code(json.report.failed.is_empty()))
}

fn table(index: &Path, report: &BuildReport, max_dropped: f64) -> String {
    let lossy = report.dropped.iter().filter(|shape| shape.dropped_area_share > max_dropped).count();
    let mut rows =
        vec![("described", report.described.to_string()), ("unchanged", report.unchanged.to_string())];
    let rare = [
        ("renamed", report.renamed),
        ("removed", report.removed),
        ("incomplete", lossy),
        ("failed", report.failed.len()),
    ];
    rows.extend(rare.into_iter().filter(|(_, n)| *n > 0).map(|(name, n)| (name, n.to_string())));
    if report.resumed {
        rows.push(("resumed", "an interrupted run".to_owned()));
    }
    rows.push(("seconds", format!("{:.2}", report.seconds)));
    rows.push(match index.exists() {
        true => ("index", format!("{}, {} shapes", index.display(), report.n_shapes)),
        false => ("index", "not written: no mesh could be described".to_owned()),
    });
    facts(&rows)
}

#[derive(Serialize)]
struct RemoveReport {
    n_shapes: usize,
    removed: usize,
}

pub(super) fn remove(index: &Path, ids: &[String], common: &Common) -> Result<ExitCode> {
    let n_shapes = remove_from_index(index, ids)?;
    let mut ids = ids.to_vec();
    ids.sort();
    ids.dedup();
    let json = Json { index: index.to_owned(), report: RemoveReport { n_shapes, removed: ids.len() } };
    report(common, &json, |json| {
        format!("{} removed, {n_shapes} shapes in {}", json.report.removed, json.index.display())
    })
}

pub(super) fn merge(inputs: &[PathBuf], output: &Path, common: &Common) -> Result<ExitCode> {
    check_folder(output)?;
    let merged = merge_indexes(inputs, output, &Bars::new(common.quiet))?;
    report(common, &Json { index: output.to_owned(), report: merged }, |json| {
        let MergeReport { n_shapes, repeated } = json.report;
        let twice =
            if repeated > 0 { format!(", {repeated} of them in more than one index") } else { String::new() };
        format!("{n_shapes} shapes in {}{twice}", json.index.display())
    })
}
