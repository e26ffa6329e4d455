//! The program `canonform`: nonrigid shapes on the command line.
//!
//! Parses arguments, calls `canonform`, prints. Knows no numerical code.

mod args;
mod commands;
mod field;
mod output;
mod remedy;

use std::process::ExitCode;

use clap::Parser;
use peak_alloc::PeakAlloc;

use crate::args::{Arguments, Command, Common};

/// Counts the heap for `canonform methods`, which reports the peak of every method.
#[global_allocator]
static ALLOCATOR: PeakAlloc = PeakAlloc;

fn main() -> ExitCode {
    let Arguments { common, command } = Arguments::parse();
    terminal::run(common.threads, || run(&command, &common).map_err(remedy::remedied))
}

fn run(command: &Command, common: &Common) -> anyhow::Result<ExitCode> {
    match command {
        Command::Info(args) => commands::info(args, common),
        Command::Geodesic(args) => commands::geodesic(args, common),
        Command::Embed(args) => commands::embed(args, common),
        Command::Methods(args) => commands::methods(args, common),
        Command::Compare(args) => commands::compare(args, common),
        Command::Render(args) => commands::picture(args, common),
        Command::Index(args) => commands::index(&args.command, common),
        Command::Search(args) => commands::search(args, common),
        Command::Evaluate(args) => commands::evaluate(args, common),
        Command::Serve(args) => commands::serve(args),
        Command::Completions(args) => commands::completions(args),
    }
}
