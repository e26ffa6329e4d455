//! The commands of the program, except `units`.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::Result;
use report::page::write_report;
use terminal::Bars;

use crate::args::RunArgs;
use crate::collection::Collection;
use crate::config::Config;
use crate::context::Context;
use crate::specimen::specimens;
use crate::table::{ALL, EXPERIMENTS, Experiment};

/// `experiments run`.
pub(crate) fn run(args: &RunArgs) -> Result<ExitCode> {
    let bars = Bars::new(args.quiet);
    let collection = Collection::load(&args.source, &bars)?;
    let specimens = specimens(&collection);
    for Experiment { section, config, run } in &EXPERIMENTS {
        if !args.names.iter().any(|name| name == section.name || name == ALL) {
            continue;
        }
        let context = Context {
            name: section.name,
            config: Config::parse(section.name, config)?,
            collection: &collection,
            specimens: &specimens,
            seed: args.source.seed,
            folder: &args.output,
            command: args.command(),
            arguments: args.arguments(),
            observer: &bars,
            bars: &bars,
            start: Instant::now(),
        };
        run(&context)?;
    }
    report(&args.output)
}

/// `experiments list`.
pub(crate) fn list() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for Experiment { section, .. } in &EXPERIMENTS {
        writeln!(out, "{:<10} {}", section.name, section.title)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `experiments report`: writes the page and prints its path.
pub(crate) fn report(folder: &Path) -> Result<ExitCode> {
    let page = write_report(folder, &EXPERIMENTS.map(|experiment| experiment.section))?;
    writeln!(std::io::stdout().lock(), "report: {}", page.display())?;
    Ok(ExitCode::SUCCESS)
}
