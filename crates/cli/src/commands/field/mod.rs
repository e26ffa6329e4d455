//! `canonform field`.
//!
//! `build` (fields, and facts about them), `query` (distances).

mod build;
mod query;

use std::process::ExitCode;

use anyhow::Result;

use crate::args::{Common, FieldCommand};

pub(crate) fn field(command: &FieldCommand, common: &Common) -> Result<ExitCode> {
    match command {
        FieldCommand::Build(args) => build::build(args, common),
        FieldCommand::Query(args) => query::query(args, common),
        FieldCommand::Info { field } => build::info(field, common),
    }
}
