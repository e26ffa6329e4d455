//! The command line.

use std::ffi::OsString;
use std::path::PathBuf;

use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, CommandFactory, FromArgMatches, Parser, Subcommand};

use crate::collection::ShapeSource;
use crate::quoted::quoted;
use crate::table::parse_name;

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
    Units {
        /// Number of seeds of the built-in dataset, from 1 on; 30 shapes each
        #[arg(long, default_value_t = 5, value_name = "N")]
        seeds: usize,
        /// Show no progress bars
        #[arg(long, short)]
        quiet: bool,
    },
    /// Measure the numbers of relations on built-in shapes: the boundary of one surface, and how often confidence is right
    Relations {
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
    pub(crate) source: ShapeSource,
    /// Folder for the results
    #[arg(short, long, default_value = OUTPUT, value_name = "OUT")]
    pub(crate) output: PathBuf,
    /// Skip experiments that the folder already has, if the same version made them with the same shapes and seed
    #[arg(long)]
    pub(crate) resume: bool,
    /// Set published scores beside those of `retrieval`: a TOML file of the form of experiments/published/*.toml
    #[arg(long, value_name = "FILE.toml")]
    pub(crate) compare: Option<PathBuf>,
    /// Worker threads; 0 for all cores. Results do not depend on it
    #[arg(long, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// Show no progress bars
    #[arg(long, short)]
    pub(crate) quiet: bool,
    /// The options that decide the results and where they are, each after a space.
    #[arg(skip)]
    pub(crate) arguments: String,
}

/// Options that do not decide the results.
const INDIFFERENT: [&str; 4] = ["names", "resume", "threads", "quiet"];

impl ExperimentArguments {
    /// Reads the command line, and keeps what decides the results of a run.
    pub(crate) fn read(words: impl IntoIterator<Item: Into<OsString> + Clone>) -> Self {
        let mut matches = Self::command().get_matches_from(words);
        let given = matches.subcommand().map(|(name, given)| repeated(name, given)).unwrap_or_default();
        let mut arguments = Self::from_arg_matches_mut(&mut matches).unwrap_or_else(|fault| fault.exit());
        if let ExperimentCommand::Run(run) = &mut arguments.command {
            run.arguments = given;
        }
        arguments
    }
}

/// The options on the command line that decide the results and where they are, each after a space, in a fixed order.
fn repeated(name: &str, given: &ArgMatches) -> String {
    let command = ExperimentArguments::command();
    let options = command.find_subcommand(name).into_iter().flat_map(clap::Command::get_arguments);
    let decides = |option: &&Arg| {
        let id = option.get_id().as_str();
        given.value_source(id) == Some(ValueSource::CommandLine) && !INDIFFERENT.contains(&id)
    };
    let written = |option: &Arg| {
        let values = given.get_raw(option.get_id().as_str()).into_iter().flatten();
        let values: Vec<_> = values.map(|value| value.to_string_lossy()).collect();
        format!(" --{} {}", option.get_long().unwrap_or_default(), quoted(&values.join(",")))
    };
    options.filter(decides).map(written).collect()
}

impl RunArgs {
    /// The command line that repeats the run.
    pub(crate) fn command(&self) -> String {
        format!("cargo run --release -p experiments -- run {}{}", self.names.join(" "), self.arguments)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(line: &str) -> RunArgs {
        match ExperimentArguments::read(format!("experiments run {line}").split(' ')).command {
            ExperimentCommand::Run(args) => args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn commands_repeat_what_decides_the_results() {
        let command = |line: &str| parsed(line).command();
        assert!(command("all").ends_with("-- run all"));
        assert!(
            command("figure1 --vertices 1000 --threads 1 -q").ends_with("-- run figure1 --vertices 1000")
        );
        assert!(command("retrieval").ends_with("-- run retrieval"));
        let line = "retrieval --families articulated,creatures:40x8 --vertices 1000";
        assert!(command(line).ends_with(line), "{}", command(line));
        let line = "figure3 --dataset my&data --classes cat,dog --seed 2 --compare a.toml -o results/1";
        let expected = "-- run figure3 --dataset 'my&data' --classes cat,dog --seed 2 --output results/1 --compare a.toml";
        assert!(command(line).ends_with(expected), "{}", command(line));
        assert_eq!(quoted("it's"), r"'it'\''s'");
    }
}
