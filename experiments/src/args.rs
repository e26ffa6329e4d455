//! The command line.

use std::path::{Path, PathBuf};

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

impl RunArgs {
    /// The options that decide the results and where they are, each after a space.
    pub(crate) fn arguments(&self) -> String {
        let mut options = self.source.options();
        let path = |path: &Path| path.display().to_string();
        options.extend((self.output != Path::new(OUTPUT)).then(|| ("output", path(&self.output))));
        options.iter().map(|(name, value)| format!(" --{name} {}", quoted(value))).collect()
    }

    /// The command line that repeats the run.
    pub(crate) fn command(&self) -> String {
        format!("cargo run --release -p experiments -- run {}{}", self.names.join(" "), self.arguments())
    }
}

/// A word of a command line, in quotes if a shell would take it apart.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || "-_./:,+=@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_repeat_what_decides_the_results() {
        for (line, expected) in [
            ("all --threads 1 -q", "all"),
            (
                "retrieval --families articulated,bodies:6x5,creatures:40x8,parts:56x4 --vertices 1000",
                "retrieval --families articulated,bodies:6x5,creatures:40x8,parts:56x4 --vertices 1000",
            ),
            (
                "figure3 --dataset my&data's --classes cat,dog --seed 2 -o results/1",
                r"figure3 --dataset 'my&data'\''s' --classes cat,dog --seed 2 --output results/1",
            ),
        ] {
            let line = format!("experiments run {line}");
            let ExperimentCommand::Run(args) = ExperimentArguments::parse_from(line.split(' ')).command
            else {
                panic!("{line}")
            };
            assert!(args.command().ends_with(&format!("-- run {expected}")), "{}", args.command());
        }
    }
}
