//! The runner's command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand};

use crate::run::Experiment;

/// Reproduces the figures of the paper, on the built-in dataset or on a folder of meshes.
#[derive(Debug, Parser)]
#[command(name = "experiments", version, max_term_width = 100)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Run experiments; write their results, figures and the page that shows them
    Run(RunArgs),
    /// Say which experiments there are
    List,
    /// Make the page again from the results in a folder
    Report(ReportArgs),
    /// Measure what poses and triangulations of the built-in shapes do to every signature
    Units(UnitsArgs),
}

#[derive(Debug, Args)]
pub(crate) struct RunArgs {
    /// Names of experiments, or `all`
    #[arg(required = true, value_name = "NAME", value_parser = Experiment::parse)]
    pub(crate) names: Vec<Experiment>,
    /// A folder of meshes; classes come from sub-folders or from the leading letters of file names
    /// [default: the built-in articulated families]
    #[arg(long, value_name = "DIR")]
    pub(crate) dataset: Option<PathBuf>,
    /// A file of lines `name,label` that gives the classes of the shapes in the folder
    #[arg(long, value_name = "FILE", requires = "dataset")]
    pub(crate) labels: Option<PathBuf>,
    /// Classes to use, in this order, or `all` [default: cat, centaur and david, which the paper shows,
    /// where a folder has these; else all]
    #[arg(long, value_delimiter = ',', value_name = "CLASS,...")]
    pub(crate) classes: Vec<String>,
    /// Folder for the results
    #[arg(short, long, default_value = "out", value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Vertices of the shapes of the built-in dataset, 1,000 to 1,000,000
    #[arg(long, default_value_t = 3400, value_name = "P", conflicts_with = "dataset")]
    pub(crate) vertices: usize,
    /// Seed of everything random
    #[arg(long, default_value_t = 0, value_name = "S")]
    pub(crate) seed: u64,
    /// Worker threads; 0 takes all cores. The result does not depend on it
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// No progress bars
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ReportArgs {
    /// Folder with the results
    #[arg(short, long, default_value = "out", value_name = "OUT")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct UnitsArgs {
    /// Seeds of the built-in dataset that take part, from 1 on; 30 shapes each
    #[arg(long, default_value_t = 5, value_name = "N")]
    pub(crate) seeds: usize,
    /// No progress bars
    #[arg(long, short)]
    pub(crate) quiet: bool,
}
