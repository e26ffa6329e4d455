//! The experiments, and the commands that run them.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use base::terminal::{Bars, note};
use report::Record;
use report::page::{Section, write_report};

use crate::args::RunArgs;
use crate::collection::SurfaceCollection;
use crate::config::Config;
use crate::context::Context;
use crate::specimen::specimens;
use crate::{paper, studies};

/// An experiment: its name, its configuration, and what it does.
type Experiment = (&'static str, &'static str, fn(&Context<'_>) -> Result<Record>);

macro_rules! experiments {
    ($($name:literal $run:path,)*) => {
        /// All experiments, in the order in which they run and appear on the page.
        const EXPERIMENTS: [Experiment; [$($name),*].len()] =
            [$(($name, include_str!(concat!("../configs/", $name, ".toml")), $run)),*];
    };
}

experiments! {
    "figure1" paper::figure1::figure1,
    "figure3" paper::figure3::figure3,
    "figure4" paper::figure4::figure4,
    "figure5a" paper::figure5::figure5a,
    "figure5b" paper::figure5::figure5b,
    "figure6" paper::figure6::figure6,
    "figure7" paper::figure7::figure7,
    "figure8" paper::figure8::figure8,
    "figure9" paper::figure9::figure9,
    "retrieval" studies::retrieval::retrieval,
    "forms" studies::forms::forms,
    "robustness" studies::robustness::robustness,
    "matching" studies::matching::matching,
    "points" studies::points::points,
    "evidence" studies::evidence::evidence,
    "scaling" studies::scaling::scaling,
}

/// Names of earlier experiments, and the one that includes them.
const INCLUDED: [(&str, &str); 2] = [("invariance", "robustness"), ("partial", "robustness")];

/// Stands for all experiments on the command line.
const ALL: &str = "all";

/// The experiments that can begin a page, the most telling first.
const LEADS: [&str; 3] = ["figure4", "retrieval", "figure1"];

/// `experiments run`.
pub(crate) fn run(args: &RunArgs) -> Result<ExitCode> {
    let known: Vec<&str> = [ALL].into_iter().chain(EXPERIMENTS.map(|(name, ..)| name)).collect();
    let current = |name| INCLUDED.iter().find(|(earlier, _)| *earlier == name).map_or(name, |(_, now)| *now);
    let names: Vec<&str> = args.names.iter().map(|name| current(name.as_str())).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(name)) {
        bail!("there is no experiment `{name}`; choose from {}", known.join(", "));
    }
    let is_wanted = |(name, ..): &Experiment| names.contains(name) || names.contains(&ALL);
    let bars = Bars::new(args.quiet);
    let collection = SurfaceCollection::load(&args.source, &bars)?;
    let specimens = specimens(&collection);
    for (name, config, experiment) in EXPERIMENTS.into_iter().filter(is_wanted) {
        let (config, options) = Config::parse(name, config)?;
        let context = Context {
            config,
            options,
            collection: &collection,
            specimens: &specimens,
            seed: args.source.seed,
            observer: &bars,
            start: Instant::now(),
        };
        let record = experiment(&context).and_then(|record| context.completed(record));
        let record = record.with_context(|| format!("experiment {name}"))?;
        bars.finish();
        for e in record.expectations.iter().filter(|e| !e.held) {
            let kind = if e.goal { "goal missed" } else { "not as expected" };
            note(&format!("{kind}: {} is {}, {}", e.what, e.measured, e.expected));
        }
        record.save(&args.output, name)?;
        if let Some(table) = record.tables.first() {
            writeln!(std::io::stdout().lock(), "{}\n{}", table.caption, table.to_text())?;
        }
    }
    report(&args.output, None)
}

/// The names and titles of all experiments.
fn sections() -> Result<Vec<Section>> {
    let section = |(name, config, _): Experiment| {
        Ok(Section { name: name.to_owned(), title: Config::parse(name, config)?.0.title })
    };
    EXPERIMENTS.into_iter().map(section).collect()
}

/// `experiments list`.
pub(crate) fn list() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for Section { name, title } in sections()? {
        writeln!(out, "{name:<10} {title}")?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `experiments report`: writes the page and prints its path; with a path, also the summary of the paper.
pub(crate) fn report(folder: &Path, markdown: Option<&Path>) -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    writeln!(out, "report: {}", write_report(folder, &LEADS, &sections()?)?.display())?;
    if let Some(path) = markdown {
        crate::summary::write(folder, path)?;
        writeln!(out, "summary: {}", path.display())?;
    }
    Ok(ExitCode::SUCCESS)
}
