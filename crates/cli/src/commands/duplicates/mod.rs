//! `canonform duplicates`.

mod page;
mod words;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use anyhow::Result;
use base::files::write_bytes;
use base::terminal::Bars;
use canonform::index::csv_field;
use canonform::{
    BuildOptions, DescribeOptions, DuplicateFile, DuplicateGroup, DuplicateOptions, DuplicateReport,
    RelationKind, ShapeSearch, build_index, find_duplicates, is_dataset,
};

use self::words::text;
use crate::args::{Common, DuplicatesArgs, KindArg};
use crate::output::{check_folder, print, print_json};

/// Finds the files of an index or a dataset that hold one shape.
pub(crate) fn duplicates(args: &DuplicatesArgs, common: &Common) -> Result<ExitCode> {
    for path in [&args.csv, &args.html].into_iter().flatten() {
        check_folder(path)?;
    }
    let bars = Bars::new(common.quiet);
    let described = is_dataset(&args.input).then(|| Described::build(&args.input, &bars)).transpose()?;
    let search = ShapeSearch::open(described.as_ref().map_or(args.input.as_path(), |index| &index.path))?;
    let kinds = args.kinds.iter().map(|kind| kind_of(*kind)).collect();
    let options = DuplicateOptions { kinds, min_confidence: args.min_confidence };
    let mut report = find_duplicates(&search, &options, &bars)?;
    bars.finish();
    report.groups.iter_mut().for_each(|group| {
        let members = group.members.iter_mut().map(|member| &mut member.file);
        members.chain([&mut group.keeper]).for_each(|file| file.path = short(&file.path));
    });
    if let Some(path) = &args.csv {
        write_bytes(path, csv(&report).as_bytes())?;
    }
    if let Some(path) = &args.html {
        write_bytes(path, page::page(&report, &search)?.as_bytes())?;
    }
    if common.json {
        print_json(&report)?;
    } else {
        print(&text(&report))?;
    }
    Ok(if report.groups.is_empty() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// The index of a dataset, which is removed in the end.
struct Described {
    path: PathBuf,
}

impl Described {
    fn build(dataset: &Path, bars: &Bars) -> Result<Self> {
        let name = format!("canonform-duplicates-{}.canonform", std::process::id());
        let index = Self { path: std::env::temp_dir().join(name) };
        let describe = DescribeOptions::default();
        let built = build_index(dataset, &index.path, &BuildOptions::new(&describe), bars)?;
        for failure in &built.failed {
            base::terminal::note(&format!("left out {}: {}", failure.path.display(), failure.error));
        }
        Ok(index)
    }
}

impl Drop for Described {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.path);
    }
}

fn kind_of(kind: KindArg) -> RelationKind {
    match kind {
        KindArg::File => RelationKind::IdenticalFile,
        KindArg::Geometry => RelationKind::IdenticalGeometry,
        KindArg::Scaled => RelationKind::Scaled,
        KindArg::Mirrored => RelationKind::Mirrored,
        KindArg::Noisy => RelationKind::Noisy,
        KindArg::Remeshed => RelationKind::Remeshed,
        KindArg::Copies => RelationKind::Copies,
        KindArg::Part => RelationKind::PartOf,
        KindArg::Variant => RelationKind::Variant,
        KindArg::Pose => RelationKind::OtherPose,
    }
}

/// The path below the current folder, if it lies there.
fn short(path: &Path) -> PathBuf {
    let Ok(whole) = path.canonicalize() else { return path.to_owned() };
    let here = std::env::current_dir().and_then(|here| here.canonicalize());
    here.ok().and_then(|here| whole.strip_prefix(here).ok().map(Path::to_owned)).unwrap_or(whole)
}

/// One line per file, keepers first.
fn csv(report: &DuplicateReport) -> String {
    let mut text = "group,role,id,path,kind,confidence,relation,bytes,modified\n".to_owned();
    for (i, DuplicateGroup { keeper, why, members }) in report.groups.iter().enumerate() {
        let mut line = |role: &str, file: &DuplicateFile, kind: &str, confidence: &str, words: &str| {
            let number = |value: Option<u64>| value.map(|value| value.to_string()).unwrap_or_default();
            let path = file.path.display().to_string();
            let cells = [
                (i + 1).to_string(),
                role.to_owned(),
                csv_field(&file.id),
                csv_field(&path),
                kind.to_owned(),
                confidence.to_owned(),
                csv_field(words),
                number(file.bytes),
                number(file.modified),
            ];
            text += &format!("{}\n", cells.join(","));
        };
        line("keep", keeper, "", "", why);
        for member in members {
            let told = &member.relation;
            let kind = serde_json::to_value(told.kind).unwrap_or_default();
            let confidence = format!("{:.3}", told.confidence);
            line("spare", &member.file, kind.as_str().unwrap_or_default(), &confidence, &told.to_string());
        }
    }
    text
}
