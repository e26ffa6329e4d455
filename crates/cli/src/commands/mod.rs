//! One module per command.

mod compare;
mod convert;
mod duplicates;
mod embed;
mod evaluate;
mod field;
mod generate;
mod geodesic;
mod index;
mod info;
mod matching;
mod methods;
mod render;
mod search;
mod serve;

use std::io::Write;
use std::process::ExitCode;

use crate::args::{Command, Common, program};

pub(crate) fn run(command: &Command, common: &Common) -> anyhow::Result<ExitCode> {
    match command {
        Command::Info(args) => info::info(args, common),
        Command::Geodesic(args) => geodesic::geodesic(args, common),
        Command::Field(command) => field::field(command, common),
        Command::Embed(args) => embed::embed(args, common),
        Command::Methods(args) => methods::methods(args, common),
        Command::Compare(args) => compare::compare(args, common),
        Command::Match(args) => matching::match_meshes(args, common),
        Command::Convert(args) => convert::convert(args, common),
        Command::Render(args) => render::draw(args, common),
        Command::Index(command) => index::index(command, common),
        Command::Search(args) => search::search(args, common),
        Command::Duplicates(args) => duplicates::duplicates(args, common),
        Command::Evaluate(args) => evaluate::evaluate(args, common),
        Command::Serve(args) => serve::serve(args),
        Command::Generate(args) => generate::generate(args, common),
        Command::Completions { shell } => {
            // Written at once: the library panics if the pipe is closed.
            let mut script = Vec::new();
            clap_complete::generate(*shell, &mut program(), "canonform", &mut script);
            std::io::stdout().lock().write_all(&script)?;
            Ok(ExitCode::SUCCESS)
        }
    }
}
