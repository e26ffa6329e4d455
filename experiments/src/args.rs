//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::collection::ShapeSource;

/// The default folder for results.
const OUTPUT: &str = "out";

/// Reproduces the figures of the paper on the built-in dataset or on a folder of meshes.
#[derive(Debug, Parser)]
#[command(name = "experiments", version, max_term_width = 100)]
pub(crate) struct ExperimentArguments {
    #[command(subcommand)]
    pub(crate) command: ExperimentCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum ExperimentCommand {
    /// Run experiments; write their results, figures and the report page
    Run(RunArgs),
    /// List the experiments
    List,
    /// Write the report page again from the results in a folder
    Report {
        /// Folder with the results
        #[arg(short, long, default_value = OUTPUT, value_name = "OUT")]
        output: PathBuf,
        /// Also write the section of the comparison with the paper (docs/paper.md) that holds our numbers, from results on
        /// its shapes, and these numbers as .json beside it
        #[arg(long, value_name = "PAGE.md")]
        markdown: Option<PathBuf>,
    },
    /// Measure the numbers of the metric on built-in shapes: units, weights, and the boundaries of shapes and classes
    Units,
    /// Measure the numbers of relations on built-in shapes: the boundary of one surface, and how often confidence is right
    Relations,
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Names of experiments (see `experiments list`), or `all`
    #[arg(required = true, value_name = "NAME")]
    pub(crate) names: Vec<String>,
    #[command(flatten)]
    pub(crate) source: ShapeSource,
    /// Folder for the results
    #[arg(short, long, default_value = OUTPUT, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Worker threads; 0 for all cores. Results do not depend on it
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// Show no progress bars
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// The command line of this run.
pub(crate) fn command() -> String {
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let words = shlex::try_join(words.iter().map(String::as_str)).unwrap_or_default();
    format!("cargo run --release -p experiments -- {words}")
}
