//! The experiment runner: every figure of the paper from one command.
//!
//! `datasets` or a folder -> **experiments** -> `report::results` (JSON) -> pictures and one page
//!
//! An experiment is a configuration (`configs/*.toml`: options, what is expected, what it shows) and a
//! module that runs it; results are data, pictures are made from them.

mod args;
mod coarse;
mod collection;
mod config;
mod figure1;
mod figure3;
mod figure4;
mod figure5;
mod figure6;
mod figure7;
mod figure8;
mod figure9;
mod memory;
mod retrieve;
mod run;
mod scaling;
mod seen;
mod specimen;
mod sweep;
mod units;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Arguments, Command};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let threads = match &arguments.command {
        Command::Run(args) => args.threads,
        Command::List | Command::Report(_) | Command::Units(_) => 0,
    };
    terminal::run(threads, || match &arguments.command {
        Command::Run(args) => run::run(args),
        Command::List => run::list(),
        Command::Report(args) => run::report(args),
        Command::Units(args) => units::units(args),
    })
}
