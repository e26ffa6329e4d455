//! The program `canonform`: parses arguments, calls the library, prints. Contains no numerical code.

mod args;
mod batch;
mod commands;
mod input;
mod output;
mod remedy;
mod table;

use std::process::ExitCode;

use crate::args::{Arguments, parsed};

fn main() -> ExitCode {
    let Arguments { common, command } = parsed();
    base::terminal::set_quiet(common.quiet);
    base::terminal::run(common.threads.into(), || {
        commands::run(&command, &common).map(input::exit_code_of).map_err(remedy::remedied)
    })
}
