//! `canonform index`.

mod change;
mod look;

pub(crate) use change::skipped;

use std::process::ExitCode;

use anyhow::Result;

use crate::args::{Common, IndexCommand};

pub(crate) fn index(command: &IndexCommand, common: &Common) -> Result<ExitCode> {
    match command {
        IndexCommand::Build(args) => change::build(args, common),
        IndexCommand::Add(args) => change::add(args, common),
        IndexCommand::Remove { index, ids } => change::remove(index, ids, common),
        IndexCommand::Merge { inputs, output } => change::merge(inputs, output, common),
        IndexCommand::Verify { index } => look::verify(index, common),
        IndexCommand::List(args) => look::list(args, common),
        IndexCommand::Info { index } => look::info(index, common),
        IndexCommand::Export { index, output, output_format } => {
            look::export(index, output.as_deref(), output_format.as_deref(), common)
        }
    }
}
