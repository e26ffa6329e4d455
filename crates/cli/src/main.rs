//! The program `canonform`: nonrigid shapes on the command line.
//!
//! Parses arguments, calls `pipeline`, prints. Knows no numerical code.

mod args;
mod commands;
mod output;
mod progress;

use std::process::ExitCode;

use clap::Parser;

use crate::args::{Arguments, Command};

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    // The pool is built once, before anything could have used it, so this cannot fail twice.
    let pool = rayon::ThreadPoolBuilder::new().num_threads(arguments.common.threads).build_global();
    let result = pool.map_err(anyhow::Error::from).and_then(|()| match &arguments.command {
        Command::Info(args) => commands::info(args, &arguments.common),
        Command::Geodesic(args) => commands::geodesic(args, &arguments.common),
        Command::Embed(args) => commands::embed(args, &arguments.common),
        Command::Compare(args) => commands::compare(args, &arguments.common),
        Command::Completions(args) => commands::completions(args),
    });
    match result {
        Ok(code) => code,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Whether whoever was reading has gone, which is no error of ours.
fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}
