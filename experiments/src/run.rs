//! Running experiments one after the other over one collection.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Result, bail};
use pipeline::{EmbedOptions, Observer};
use report::page::write_report;
use report::results::{Expectation, Provenance};
use terminal::Bars;

use crate::args::{ReportArgs, RunArgs};
use crate::collection::Collection;
use crate::config::Config;
use crate::{figure1, figure4};

/// An experiment of the runner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Experiment {
    All,
    Figure1,
    Figure4,
}

impl Experiment {
    const EACH: [Self; 2] = [Self::Figure1, Self::Figure4];

    fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Figure1 => "figure1",
            Self::Figure4 => "figure4",
        }
    }

    /// The experiment of this name.
    pub(crate) fn parse(name: &str) -> Result<Self, String> {
        let known = [Self::All].into_iter().chain(Self::EACH);
        let names: Vec<_> = known.clone().map(Self::name).collect();
        known
            .into_iter()
            .find(|experiment| experiment.name() == name)
            .ok_or_else(|| format!("there is no experiment `{name}`; choose from {}", names.join(", ")))
    }

    fn config(self) -> Result<Config> {
        let text = match self {
            Self::All => bail!("`all` is not one experiment"),
            Self::Figure1 => include_str!("../configs/figure1.toml"),
            Self::Figure4 => include_str!("../configs/figure4.toml"),
        };
        Config::parse(self.name(), text)
    }

    fn run(self, context: &Context<'_>) -> Result<()> {
        match self {
            Self::All => bail!("`all` is not one experiment"),
            Self::Figure1 => figure1::run(context),
            Self::Figure4 => figure4::run(context),
        }
    }
}

/// What every experiment is handed.
pub(crate) struct Context<'a> {
    pub(crate) args: &'a RunArgs,
    pub(crate) collection: &'a Collection,
    pub(crate) config: Config,
    pub(crate) observer: &'a dyn Observer,
    bars: &'a Bars,
}

impl Context<'_> {
    /// A path in the folder for results.
    pub(crate) fn output(&self, name: &str) -> PathBuf {
        self.args.output.join(name)
    }

    /// Holds the configured expectations against what was measured and says which failed.
    pub(crate) fn check(&self, measured: impl Fn(&str) -> Option<f64>) -> Result<Vec<Expectation>> {
        let found = self.config.check(self.collection.setting(), measured)?;
        self.bars.finish();
        for failed in found.iter().filter(|expectation| !expectation.held) {
            eprintln!("not as expected: {} is {}, {}", failed.what, failed.measured, failed.expected);
        }
        Ok(found)
    }

    /// What made the record.
    pub(crate) fn provenance(
        &self,
        options: &[(&str, &EmbedOptions)],
        elapsed: Duration,
    ) -> Result<Provenance> {
        let options: serde_json::Map<_, _> =
            options.iter().map(|(name, options)| ((*name).to_owned(), described(options))).collect();
        Ok(Provenance {
            program: "canonform experiments".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: command(self.args),
            dataset: self.collection.dataset.clone(),
            classes: self.collection.classes.clone(),
            seed: self.args.seed,
            options: serde_json::Value::Object(options),
            seconds: [("run".to_owned(), elapsed.as_secs_f64())].into(),
        })
    }

    /// Prints text for people.
    pub(crate) fn say(&self, text: &str) -> Result<()> {
        self.bars.finish();
        writeln!(std::io::stdout().lock(), "{text}")?;
        Ok(())
    }
}

/// The options of an embedding as a record shows them.
fn described(options: &EmbedOptions) -> serde_json::Value {
    serde_json::json!({
        "method": format!("{:?}", options.method),
        "geodesic": format!("{:?}", options.geodesic),
        "samples": format!("{:?}", options.samples),
        "first_sample": format!("{:?}", options.first_sample),
        "dim": options.dim,
        "stress": format!("{:?}", options.stress),
    })
}

/// The command that repeats a run.
fn command(args: &RunArgs) -> String {
    let names: Vec<_> = args.names.iter().map(|name| name.name()).collect();
    let mut command = format!("cargo run --release -p experiments -- run {}", names.join(" "));
    if let Some(folder) = &args.dataset {
        command += &format!(" --dataset {}", folder.display());
    } else if args.vertices != 3400 {
        command += &format!(" --vertices {}", args.vertices);
    }
    if let Some(labels) = &args.labels {
        command += &format!(" --labels {}", labels.display());
    }
    if !args.classes.is_empty() {
        command += &format!(" --classes {}", args.classes.join(","));
    }
    if args.seed != 0 {
        command += &format!(" --seed {}", args.seed);
    }
    command
}

/// `experiments run`.
pub(crate) fn run(args: &RunArgs) -> Result<ExitCode> {
    let bars = Bars::new(args.quiet);
    let collection = Collection::load(args, &bars)?;
    for experiment in Experiment::EACH {
        if !(args.names.contains(&experiment) || args.names.contains(&Experiment::All)) {
            continue;
        }
        let config = experiment.config()?;
        experiment.run(&Context { args, collection: &collection, config, observer: &bars, bars: &bars })?;
        bars.finish();
    }
    let page = write_report(&args.output)?;
    writeln!(std::io::stdout().lock(), "report: {}", page.display())?;
    Ok(ExitCode::SUCCESS)
}

/// `experiments list`.
pub(crate) fn list() -> Result<ExitCode> {
    let mut out = std::io::stdout().lock();
    for experiment in Experiment::EACH {
        writeln!(out, "{:<10} {}", experiment.name(), experiment.config()?.title)?;
    }
    Ok(ExitCode::SUCCESS)
}

/// `experiments report`.
pub(crate) fn report(args: &ReportArgs) -> Result<ExitCode> {
    let page = write_report(&args.output)?;
    writeln!(std::io::stdout().lock(), "report: {}", page.display())?;
    Ok(ExitCode::SUCCESS)
}
