//! The commands of the program, except `units`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context as _, Result};
use base::terminal::{Bars, on_interruption};
use report::page::write_report;
use report::results::{Published, RunProvenance, provenance};

use crate::args::RunArgs;
use crate::collection::SurfaceCollection;
use crate::context::Context;
use crate::lead::lead;
use crate::specimen::specimens;
use crate::table::{ALL, EXPERIMENTS, TableEntry};

/// Exit code after an interruption, by the convention of shells: 128 plus the number of the signal.
const INTERRUPTED: i32 = 130;

/// `experiments run`.
pub(crate) fn run(args: &RunArgs) -> Result<ExitCode> {
    let is_wanted =
        |entry: &&TableEntry| args.names.iter().any(|name| name == entry.section.name || name == ALL);
    let (kept, open): (Vec<&TableEntry>, Vec<&TableEntry>) =
        EXPERIMENTS.iter().filter(is_wanted).partition(|entry| args.resume && is_made(args, entry));
    let finished: Vec<&'static str> = kept.iter().map(|entry| entry.section.name).collect();
    for name in &finished {
        eprintln!("{name} is there already, made with these options");
    }
    let finished = Arc::new(Mutex::new(finished));
    keep_finished(args, Arc::clone(&finished));
    let published = args.compare.as_deref().map(published).transpose()?;
    if !open.is_empty() {
        let bars = Bars::new(args.quiet);
        let collection = SurfaceCollection::load(&args.source, &bars)?;
        let specimens = specimens(&collection);
        for entry in open {
            let (config, experiment) = entry.parse()?;
            let context = Context {
                name: entry.section.name,
                config,
                collection: &collection,
                specimens: &specimens,
                seed: args.source.seed,
                folder: &args.output,
                published: published.as_ref(),
                command: args.command(),
                arguments: args.arguments.clone(),
                observer: &bars,
                bars: &bars,
                start: Instant::now(),
            };
            experiment.run(&context)?;
            finished.lock().unwrap_or_else(PoisonError::into_inner).push(entry.section.name);
        }
    }
    report(&args.output, None)
}

/// Reads published scores.
fn published(path: &Path) -> Result<Published> {
    let text = std::fs::read_to_string(path).with_context(|| path.display().to_string())?;
    toml::from_str(&text).with_context(|| path.display().to_string())
}

/// Whether the folder has the record of an experiment that this program would make again.
fn is_made(args: &RunArgs, entry: &TableEntry) -> bool {
    let path = args.output.join(format!("{}.json", entry.section.name));
    let [version, commit] = [env!("CARGO_PKG_VERSION"), env!("CANONFORM_COMMIT")];
    provenance(path).is_ok_and(|made: RunProvenance| {
        made.version == version && made.commit == commit && made.arguments == args.arguments
    })
}

/// On an interruption, writes the page of what is finished, names it, and says how to continue.
fn keep_finished(args: &RunArgs, finished: Arc<Mutex<Vec<&'static str>>>) {
    let (folder, command) = (args.output.clone(), args.command());
    on_interruption(move || {
        let names = finished.lock().unwrap_or_else(PoisonError::into_inner).join(", ");
        if names.is_empty() {
            eprintln!("interrupted; no experiment is finished");
        } else {
            let page = write_page(&folder).map_or_else(|e| e.to_string(), |page| page.display().to_string());
            eprintln!("interrupted; finished: {names} (report: {page})");
            eprintln!("to continue: {command} --resume");
        }
        base::files::abandon_unfinished();
        std::process::exit(INTERRUPTED);
    });
}

/// `experiments list`.
pub(crate) fn list() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for TableEntry { section, .. } in &EXPERIMENTS {
        writeln!(out, "{:<10} {}", section.name, section.title)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn write_page(folder: &Path) -> Result<std::path::PathBuf> {
    Ok(write_report(folder, &lead(folder)?, &EXPERIMENTS.map(|entry| entry.section))?)
}

/// `experiments report`: writes the page and prints its path; with a path, also the summary of the paper.
pub(crate) fn report(folder: &Path, markdown: Option<&Path>) -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "report: {}", write_page(folder)?.display())?;
    if let Some(path) = markdown {
        crate::paper::write(folder, path)?;
        writeln!(out, "summary: {}", path.display())?;
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_files_of_published_scores_can_be_read() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("published");
        let files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|file| file.unwrap().path()).collect();
        assert!(!files.is_empty());
        for path in files {
            let found = published(&path).unwrap();
            assert!(!found.method.is_empty(), "{}", path.display());
            for method in &found.method {
                let scores = [method.nn, method.ft, method.st, method.e, method.dcg, method.map];
                assert!(
                    !method.source.is_empty() && scores.iter().flatten().all(|s| (0.0..=1.0).contains(s))
                );
                assert!(scores.iter().any(Option::is_some), "{}", method.name);
            }
        }
    }

    #[test]
    fn an_unknown_score_is_an_error_that_names_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.toml");
        std::fs::write(&path, "collection = \"c\"\n[[method]]\nname = \"m\"\nsource = \"s\"\nftt = 1.0\n")
            .unwrap();
        let fault = format!("{:#}", published(&path).unwrap_err());
        assert!(fault.contains("a.toml") && fault.contains("ftt"), "{fault}");
    }
}
