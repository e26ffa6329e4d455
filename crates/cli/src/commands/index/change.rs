//! `canonform index build | add | remove | merge`.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use base::object;
use base::terminal::Bars;
use canonform::collection::{LabelOrigin, LabelSource};
use canonform::index::damaged_path;
use canonform::library::{
    BuildOptions, BuildReport, FailureReason, Inputs, MergeReport, add_to_index, build_index, merge_indexes,
    remove_from_index,
};

use crate::args::{AddArgs, BuildArgs, Common, MAX_DROPPED};
use crate::input::{check_dropped, is_named};
use crate::output::{Answer, check_output, count, exit_code, report, shown};
use crate::remedy::with_remedy;

pub(super) fn build(args: &BuildArgs, common: &Common) -> Result<ExitCode> {
    check_output(&args.output, "an index", &[])?;
    let labels = args.labels.as_deref().map(LabelSource::read).transpose()?;
    let describe = args.description.options(args.form.options(&args.method, common)?);
    let options = BuildOptions {
        labels: labels.as_ref(),
        shard: args.shard,
        prune: args.prune,
        limits: args.limits.each(),
        ..BuildOptions::new(&describe)
    };
    let built = build_index(&args.folder, &args.output, &options, &Bars::new(common.quiet))?;
    let max_dropped = args.form.repair.max_dropped;
    summarize(&args.output, built, labels.as_ref(), max_dropped, common)
}

pub(super) fn add(args: &AddArgs, common: &Common) -> Result<ExitCode> {
    let labels = args.labels.as_deref().map(LabelSource::read).transpose()?;
    let inputs = Inputs {
        paths: &args.meshes,
        labels: labels.as_ref(),
        label: args.label.as_deref(),
        limits: args.limits.each(),
    };
    let added = add_to_index(&args.index, &inputs, args.replace, &Bars::new(common.quiet))?;
    summarize(&args.index, added, labels.as_ref(), MAX_DROPPED, common)
}

/// Most names that a note lists, and most lines of a file.
const MOST_NAMED: usize = 10;
const MOST_LINES: usize = 3;

/// Prints what happened to the meshes, those that lost more of their surface than allowed and failures last.
fn summarize(
    index: &Path,
    built: BuildReport,
    labels: Option<&LabelSource>,
    max_dropped: f64,
    common: &Common,
) -> Result<ExitCode> {
    let json = object! {
        index,
        #[serde(flatten)]
        built: &built,
    };
    report(common, &json, |_| answer(index, &built, max_dropped).text(common))?;
    notes(index, &built, labels).iter().for_each(|note| base::terminal::note(note));
    for shape in &built.dropped {
        check_dropped(&shape.id, shape.dropped_area_share, max_dropped);
    }
    for failure in &built.failed {
        let message = match is_named(&failure.path, &failure.error) {
            true => failure.error.clone(),
            false => format!("{}: {}", failure.path.display(), failure.error),
        };
        base::terminal::error(&with_remedy(message, failure.remedy));
    }
    Ok(exit_code(built.failed.is_empty()))
}

/// What users should know although nothing failed.
fn notes(index: &Path, built: &BuildReport, labels: Option<&LabelSource>) -> Vec<String> {
    let mut notes = Vec::new();
    if built.replaced_damaged {
        notes.push(format!(
            "warning: the index could not be read and was built again from this folder; {} keeps the earlier file",
            damaged_path(index).display()
        ));
    }
    if let Some(class) = &built.single_class {
        notes.push(format!(
            "warning: nearly all names begin with `{class}`, which would be the only class, so the shapes have none; put \
             each class into a sub-folder, or pass --labels FILE.csv"
        ));
    }
    if let (Some(file), [_, ..]) = (labels.and_then(LabelSource::file), &built.unused_label_lines[..]) {
        notes.push(unused_labels(&file.path, built));
    }
    notes.extend(skipped(built));
    let kept = &built.unreadable;
    notes.extend(
        kept.iter().take(MOST_NAMED).map(|id| format!("warning: kept {id}, which cannot be read now")),
    );
    if built.elsewhere > 0 {
        let n = built.elsewhere;
        notes.push(format!(
            "note: {n} shapes did not come from this folder and were kept; --prune removes them"
        ));
    }
    notes
}

/// What was skipped although it may hold meshes.
pub(crate) fn skipped(built: &BuildReport) -> Vec<String> {
    let skipped = &built.skipped_paths;
    let named = skipped.iter().take(MOST_NAMED);
    let named = named.map(|it| format!("warning: skipped {}: {}", it.path.display(), it.kind));
    let more = skipped.len().checked_sub(MOST_NAMED).filter(|more| *more > 0);
    named.chain(more.map(|more| format!("warning: skipped {more} more"))).collect()
}

/// The lines of a label file that name no shape.
fn unused_labels(path: &Path, built: &BuildReport) -> String {
    let lines = &built.unused_label_lines;
    let named =
        lines.iter().take(MOST_LINES).map(|unused| format!("line {}, `{}`", unused.line, unused.name));
    let more = if lines.len() > MOST_LINES { "; ..." } else { "" };
    let (n, names) = (count(lines.len(), "line"), if lines.len() == 1 { "names" } else { "name" });
    let named = named.collect::<Vec<_>>().join("; ");
    format!("warning: {n} of {} {names} no shape: {named}{more}", path.display())
}

/// What the classes of a folder were taken from.
fn classes(report: &BuildReport) -> Option<String> {
    let from = match report.labels_from? {
        LabelOrigin::None => return Some("none".to_owned()),
        LabelOrigin::Folders => "sub-folders; pass --labels none to have none",
        LabelOrigin::Names => "leading letters of file names; pass --labels none to have none",
        LabelOrigin::File => "the label file",
        LabelOrigin::Dataset => "the dataset",
    };
    Some(format!("{} from {from}", report.n_classes))
}

fn answer(index: &Path, report: &BuildReport, max_dropped: f64) -> Answer {
    let (name, described, unchanged) = (index.display(), report.described - report.copies, report.unchanged);
    let sentence = match index.exists() {
        true => {
            let holds = count(report.n_shapes, "shape");
            format!("{name} holds {holds}: {described} described, {unchanged} unchanged")
        }
        false => format!("{name} was not written: no mesh could be described"),
    };
    let lossy = report.dropped.iter().filter(|shape| shape.dropped_area_share > max_dropped).count();
    let skipped: Vec<String> = report.skipped.iter().map(|(kind, n)| format!("{kind} ({n})")).collect();
    let rare = [
        ("renamed", report.renamed),
        ("copies of other files", report.copies),
        ("removed", report.removed),
        ("kept although unreadable", report.unreadable.len()),
        ("pruned", report.pruned),
        ("from elsewhere", report.elsewhere),
        ("unlabelled", report.unlabelled),
    ];
    let rare = rare.into_iter().filter(|(_, n)| *n > 0).map(|(name, n)| format!("{n} {name}"));
    let resumed = report.resumed.then(|| "an interrupted run was resumed".to_owned());
    let others: Vec<String> = rare.chain(resumed).collect();
    let facts = [
        ("classes", classes(report).unwrap_or_default()),
        ("failed", failures(report)),
        ("incomplete", if lossy > 0 { lossy.to_string() } else { String::new() }),
        ("skipped", skipped.join(", ")),
        ("also", others.join(", ")),
    ];
    let facts = facts.into_iter().filter(|(_, value)| !value.is_empty()).collect();
    Answer { sentence, facts, details: vec![("seconds", format!("{:.2}", report.seconds))] }
}

/// The number of failures, and how many there are for each reason.
fn failures(report: &BuildReport) -> String {
    let reasons = [
        (FailureReason::Unreadable, "unreadable"),
        (FailureReason::TooLarge, "too large"),
        (FailureReason::Time, "over the time limit"),
        (FailureReason::Memory, "over the memory limit"),
        (FailureReason::Shape, "without a description"),
    ];
    let count = |reason| report.failed.iter().filter(|failure| failure.reason == reason).count();
    let parts = reasons.map(|(reason, words)| (count(reason), words)).into_iter().filter(|(n, _)| *n > 0);
    let parts: Vec<String> = parts.map(|(n, words)| format!("{n} {words}")).collect();
    if parts.is_empty() { String::new() } else { format!("{}: {}", report.failed.len(), parts.join(", ")) }
}

pub(super) fn remove(index: &Path, ids: &[String], common: &Common) -> Result<ExitCode> {
    let n_shapes = remove_from_index(index, ids)?;
    let removed = ids.iter().collect::<HashSet<_>>().len();
    report(common, &object! { index, n_shapes, removed }, |_| {
        format!("{removed} removed, {} in {}", count(n_shapes, "shape"), shown(index))
    })
}

pub(super) fn merge(inputs: &[PathBuf], output: &Path, common: &Common) -> Result<ExitCode> {
    check_output(output, "an index", &[])?;
    let MergeReport { n_shapes, repeated } = merge_indexes(inputs, output, &Bars::new(common.quiet))?;
    report(common, &object! { index: output, n_shapes, repeated }, |_| {
        let twice =
            if repeated > 0 { format!(", {repeated} of them in more than one index") } else { String::new() };
        format!("{} in {}{twice}", count(n_shapes, "shape"), shown(output))
    })
}
