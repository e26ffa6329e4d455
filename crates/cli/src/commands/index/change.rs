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

use super::super::is_named;
use crate::args::{AddArgs, BuildArgs, Common, MergeArgs, RemoveArgs};
use crate::output::{check_folder, facts, print, print_json};
use crate::remedy::with_remedy;

#[derive(Serialize)]
struct Json<T: Serialize> {
    index: PathBuf,
    #[serde(flatten)]
    report: T,
}

fn labels(path: Option<&PathBuf>) -> Result<Option<LabelFile>> {
    Ok(path.map(|path| LabelFile::read(path)).transpose()?)
}

pub(super) fn build(args: &BuildArgs, common: &Common) -> Result<ExitCode> {
    check_folder(&args.output)?;
    let labels = labels(args.labels.as_ref())?;
    let describe = args.describe.options(common)?;
    let options = BuildOptions { describe: &describe, labels: labels.as_ref(), shard: args.shard };
    let bars = Bars::new(common.quiet);
    let report = build_index(&args.folder, &args.output, &options, &bars);
    bars.finish();
    tell(&args.output, report?, common)
}

pub(super) fn add(args: &AddArgs, common: &Common) -> Result<ExitCode> {
    let labels = labels(args.labels.as_ref())?;
    let inputs = Inputs { paths: &args.meshes, labels: labels.as_ref(), label: args.label.as_deref() };
    let bars = Bars::new(common.quiet);
    let report = add_to_index(&args.index, &inputs, args.replace, &bars);
    bars.finish();
    tell(&args.index, report?, common)
}

/// Prints what became of the meshes, those that failed last.
fn tell(index: &Path, report: BuildReport, common: &Common) -> Result<ExitCode> {
    let code = if report.failed.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(2) };
    if common.json {
        print_json(&Json { index: index.to_owned(), report: &report })?;
    } else {
        print(&table(index, &report))?;
    }
    for failure in &report.failed {
        let message = with_remedy(&failure.error, failure.remedy);
        match is_named(&failure.path, &failure.error) {
            true => eprintln!("error: {message}"),
            false => eprintln!("error: {}: {message}", failure.path.display()),
        }
    }
    Ok(code)
}

fn table(index: &Path, report: &BuildReport) -> String {
    let mut rows =
        vec![("described", report.described.to_string()), ("unchanged", report.unchanged.to_string())];
    let rare = [("renamed", report.renamed), ("removed", report.removed), ("failed", report.failed.len())];
    rows.extend(rare.into_iter().filter(|(_, n)| *n > 0).map(|(name, n)| (name, n.to_string())));
    if report.resumed {
        rows.push(("resumed", "an interrupted run".to_owned()));
    }
    rows.push(("seconds", format!("{:.2}", report.seconds)));
    rows.push(match index.exists() {
        true => ("index", format!("{}, {} shapes", index.display(), report.n_shapes)),
        false => ("index", "none: no mesh could be described".to_owned()),
    });
    facts(&rows)
}

#[derive(Serialize)]
struct RemoveReport {
    n_shapes: usize,
    removed: usize,
}

pub(super) fn remove(args: &RemoveArgs, common: &Common) -> Result<ExitCode> {
    let n_shapes = remove_from_index(&args.index, &args.ids)?;
    let mut ids = args.ids.clone();
    ids.sort();
    ids.dedup();
    let report = RemoveReport { n_shapes, removed: ids.len() };
    if common.json {
        print_json(&Json { index: args.index.clone(), report })?;
    } else {
        print(&format!("{} removed, {n_shapes} shapes in {}", report.removed, args.index.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}

pub(super) fn merge(args: &MergeArgs, common: &Common) -> Result<ExitCode> {
    check_folder(&args.output)?;
    let bars = Bars::new(common.quiet);
    let report = merge_indexes(&args.inputs, &args.output, &bars);
    bars.finish();
    let report = report?;
    if common.json {
        print_json(&Json { index: args.output.clone(), report })?;
    } else {
        let MergeReport { n_shapes, repeated } = report;
        let twice =
            if repeated > 0 { format!(", {repeated} of them in more than one") } else { String::new() };
        print(&format!("{n_shapes} shapes in {}{twice}", args.output.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}
