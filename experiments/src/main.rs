//! The experiment runner: reproduces every figure of the paper with one command.
//!
//! `datasets` or a folder -> **experiments** -> `report::results` (JSON) -> figures and one page
//!
//! An experiment is a configuration (`configs/*.toml`: options, expectations, analysis), a module in `table`, and a
//! line in [`table::EXPERIMENTS`]. Its results are data, of which `report` makes figures, tables and the page.

mod args;
mod bound;
mod coarse;
mod collection;
mod config;
mod context;
mod described;
mod families;
mod machine;
mod paper;
mod prose;
mod quoted;
mod run;
mod specimen;
mod surfaces;
mod sweep;
mod table;
mod thresholds;
mod units;

use std::process::ExitCode;

use clap::Parser;
use peak_alloc::PeakAlloc;

use crate::args::{Arguments, Command};

/// Counts the heap for the experiments that measure memory.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let threads = match &arguments.command {
        Command::Run(args) => args.threads,
        _ => 0,
    };
    terminal::run(threads, || match &arguments.command {
        Command::Run(args) => run::run(args),
        Command::List => run::list(),
        Command::Report { output, markdown } => run::report(output, markdown.as_deref()),
        Command::Units { seeds, quiet } => units::units(*seeds, *quiet),
    })
}
