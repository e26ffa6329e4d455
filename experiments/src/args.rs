//! The command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::collection::Source;
use crate::table::parse_name;

/// Reproduces the figures of the paper on the built-in dataset or on a folder of meshes.
#[derive(Debug, Parser)]
#[command(name = "experiments", version, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run experiments; write their results, figures and the report page
    Run(RunArgs),
    /// List the experiments
    List,
    /// Write the report page again from the results in a folder
    Report {
        /// Folder with the results
        #[arg(short, long, default_value = "out", value_name = "OUT")]
        output: PathBuf,
    },
    /// Measure how poses and triangulations of the built-in shapes change every signature
    Units {
        /// Number of seeds of the built-in dataset, from 1 on; 30 shapes each
        #[arg(long, default_value_t = 5, value_name = "N")]
        seeds: usize,
        /// Show no progress bars
        #[arg(long, short)]
        quiet: bool,
    },
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Names of experiments (see `experiments list`), or `all`
    #[arg(required = true, value_name = "NAME", value_parser = parse_name)]
    pub(crate) names: Vec<String>,
    #[command(flatten)]
    pub(crate) source: Source,
    /// Folder for the results
    #[arg(short, long, default_value = "out", value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Worker threads; 0 for all cores. Results do not depend on it
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// Show no progress bars
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

impl RunArgs {
    /// The command line that repeats the run.
    pub(crate) fn command(&self) -> String {
        format!(
            "cargo run --release -p experiments -- run {}{}",
            self.names.join(" "),
            self.source.arguments()
        )
    }
}
