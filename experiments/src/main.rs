//! The experiment runner: reproduces every figure of the paper with one command.
//!
//! `datasets` or a folder -> **experiments** -> `report::results` (JSON) -> figures and one page
//!
//! An experiment is a configuration (`configs/*.toml`: options, expectations, analysis), a module in `table` with the type of
//! its options, and a line in [`table::EXPERIMENTS`]. Its results are data, of which `report` makes figures, tables and the page.

mod args;
mod bound;
mod boundaries;
mod coarse;
mod collection;
mod config;
mod context;
mod experiment;
mod families;
mod gallery;
mod lead;
mod machine;
mod paper;
mod parts;
mod prose;
mod quoted;
mod relations;
mod run;
mod specimen;
mod surfaces;
mod sweep;
mod table;
mod units;

use std::process::ExitCode;

use peak_alloc::PeakAlloc;

use crate::args::{ExperimentArguments, ExperimentCommand};

/// Counts the heap for the experiments that measure memory.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

fn main() -> ExitCode {
    let arguments = ExperimentArguments::read(std::env::args_os());
    let threads = match &arguments.command {
        ExperimentCommand::Run(args) => args.threads,
        _ => 0,
    };
    base::terminal::run(threads, || match &arguments.command {
        ExperimentCommand::Run(args) => run::run(args),
        ExperimentCommand::List => run::list(),
        ExperimentCommand::Report { output, markdown } => run::report(output, markdown.as_deref()),
        ExperimentCommand::Units { seeds, quiet } => units::units(*seeds, *quiet),
        ExperimentCommand::Relations { quiet } => relations::relations(*quiet),
    })
}
