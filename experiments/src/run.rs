//! Running experiments one after the other over one collection.

use std::io::Write;
use std::path::PathBuf;
use std::process::ExitCode;
use std::time::Duration;

use anyhow::{Result, bail};
use canonform::{FormOptions, Observer, StressChoice};
use report::page::write_report;
use report::results::{Expectation, Provenance};
use terminal::Bars;

use crate::args::{ReportArgs, RunArgs};
use crate::collection::{Collection, Setting};
use crate::config::Config;
use crate::specimen::{Distances, Specimen, specimens};
use crate::{figure1, figure3, figure4, figure5, figure6, figure7, figure8, figure9, retrieve, scaling};

/// An experiment of the runner.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Experiment {
    All,
    Figure1,
    Figure3,
    Figure4,
    Figure5a,
    Figure5b,
    Figure6,
    Figure7,
    Figure8,
    Figure9,
    Retrieval,
    Scaling,
}

impl Experiment {
    const EACH: [Self; 11] = [
        Self::Figure1,
        Self::Figure3,
        Self::Figure4,
        Self::Figure5a,
        Self::Figure5b,
        Self::Figure6,
        Self::Figure7,
        Self::Figure8,
        Self::Figure9,
        Self::Retrieval,
        Self::Scaling,
    ];

    fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Figure1 => "figure1",
            Self::Figure3 => "figure3",
            Self::Figure4 => "figure4",
            Self::Figure5a => "figure5a",
            Self::Figure5b => "figure5b",
            Self::Figure6 => "figure6",
            Self::Figure7 => "figure7",
            Self::Figure8 => "figure8",
            Self::Figure9 => "figure9",
            Self::Retrieval => "retrieval",
            Self::Scaling => "scaling",
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
            Self::Figure3 => include_str!("../configs/figure3.toml"),
            Self::Figure4 => include_str!("../configs/figure4.toml"),
            Self::Figure5a => include_str!("../configs/figure5a.toml"),
            Self::Figure5b => include_str!("../configs/figure5b.toml"),
            Self::Figure6 => include_str!("../configs/figure6.toml"),
            Self::Figure7 => include_str!("../configs/figure7.toml"),
            Self::Figure8 => include_str!("../configs/figure8.toml"),
            Self::Figure9 => include_str!("../configs/figure9.toml"),
            Self::Retrieval => include_str!("../configs/retrieval.toml"),
            Self::Scaling => include_str!("../configs/scaling.toml"),
        };
        Config::parse(self.name(), text)
    }

    fn run(self, context: &Context<'_>) -> Result<()> {
        match self {
            Self::All => bail!("`all` is not one experiment"),
            Self::Figure1 => figure1::run(context),
            Self::Figure3 => figure3::run(context),
            Self::Figure4 => figure4::run(context),
            Self::Figure5a => figure5::rank(context),
            Self::Figure5b => figure5::alpha(context),
            Self::Figure6 => figure6::run(context),
            Self::Figure7 => figure7::run(context),
            Self::Figure8 => figure8::run(context),
            Self::Figure9 => figure9::run(context),
            Self::Retrieval => retrieve::run(context),
            Self::Scaling => scaling::run(context),
        }
    }
}

/// What every experiment is handed.
pub(crate) struct Context<'a> {
    pub(crate) args: &'a RunArgs,
    pub(crate) collection: &'a Collection,
    /// The shapes that figures look at closely.
    pub(crate) specimens: &'a [Specimen<'a>],
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
    pub(crate) fn provenance(&self, options: serde_json::Value, elapsed: Duration) -> Provenance {
        Provenance {
            program: "canonform experiments".to_owned(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            command: command(self.args),
            dataset: self.collection.dataset.clone(),
            classes: self.collection.classes.clone(),
            seed: self.args.seed,
            options,
            seconds: [("run".to_owned(), elapsed.as_secs_f64())].into(),
        }
    }

    /// The options of an experiment on the specimens, as a record shows them.
    pub(crate) fn setup(&self) -> serde_json::Value {
        let config = &self.config;
        serde_json::json!({
            "shapes": self.specimens.iter().map(Specimen::name).collect::<Vec<_>>(),
            "samples": config.samples,
            "rank": config.rank,
            "runs": config.runs,
            "eigenvectors": config.eigenvectors,
            "counts": config.counts,
            "exponents": config.exponents,
            "distances": format!("{:?}", Distances::default().method),
        })
    }

    /// A number of the paper, where this is its data.
    pub(crate) fn printed(&self, row: &str, method: &str) -> Option<f64> {
        let is_there = self.collection.setting() == Setting::Paper;
        let printed = self.config.printed.iter().find(|p| p.row == row && p.method == method);
        printed.filter(|_| is_there).map(|p| p.value)
    }

    /// Prints text for people.
    pub(crate) fn say(&self, text: &str) -> Result<()> {
        self.bars.finish();
        writeln!(std::io::stdout().lock(), "{text}")?;
        Ok(())
    }
}

/// The options of embeddings as a record shows them.
pub(crate) fn described(options: &[(&str, &FormOptions)], stress: StressChoice) -> serde_json::Value {
    let options = options.iter().map(|(name, options)| ((*name).to_owned(), of_embedding(options, stress)));
    serde_json::Value::Object(options.collect())
}

fn of_embedding(options: &FormOptions, stress: StressChoice) -> serde_json::Value {
    serde_json::json!({
        "method": format!("{:?}", options.method),
        "geodesic": format!("{:?}", options.geodesic),
        "samples": format!("{:?}", options.samples),
        "first_sample": format!("{:?}", options.first_sample),
        "dim": options.dim,
        "stress": format!("{stress:?}"),
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
    let specimens = specimens(&collection);
    for experiment in Experiment::EACH {
        if !(args.names.contains(&experiment) || args.names.contains(&Experiment::All)) {
            continue;
        }
        let config = experiment.config()?;
        experiment.run(&Context {
            args,
            collection: &collection,
            specimens: &specimens,
            config,
            observer: &bars,
            bars: &bars,
        })?;
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
