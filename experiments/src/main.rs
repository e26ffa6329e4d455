//! The experiment runner: reproduces every figure of the paper with one command.
//!
//! `datasets` or a folder -> **experiments** -> `report::Record` (JSON) -> figures and one page
//!
//! An experiment is a configuration (`configs/*.toml`: title, options, expectations, texts), a function from the [`context`]
//! to a record in [`paper`] or [`studies`], and a line in [`run`]. [`calibration`] measures the constants of the libraries.

mod args;
mod calibration;
mod collection;
mod config;
mod context;
mod families;
mod gallery;
mod machine;
mod paper;
mod parts;
mod run;
mod specimen;
mod studies;
mod summary;
mod surfaces;
mod sweep;
mod text;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{ExperimentArguments, ExperimentCommand};

fn main() -> ExitCode {
    let arguments = ExperimentArguments::parse();
    let threads = match &arguments.command {
        ExperimentCommand::Run(args) => args.threads,
        _ => 0,
    };
    base::terminal::run(threads, || match &arguments.command {
        ExperimentCommand::Run(args) => run::run(args),
        ExperimentCommand::List => run::list(),
        ExperimentCommand::Report { output, markdown } => run::report(output, markdown.as_deref()),
        ExperimentCommand::Units => calibration::units(),
        ExperimentCommand::Relations => calibration::relations(),
    })
}
