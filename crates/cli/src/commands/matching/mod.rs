//! `canonform match`.
//!
//! `pair` (two meshes), `collection` (more), `known` (landmarks and initial maps), `transfer` (values and labels), `files` (maps,
//! pictures and functional maps).

mod collection;
mod files;
mod known;
mod pair;
mod transfer;

use std::process::ExitCode;

use anyhow::{Result, bail};
use canonform::CorrespondOptions;

use crate::args::{Common, MatchArgs};
use crate::input::expand;

/// Maps the vertices of one mesh to those of another, or several meshes to each other.
pub(crate) fn match_meshes(args: &MatchArgs, common: &Common) -> Result<ExitCode> {
    let mut options = CorrespondOptions { form: args.form.options(common)?, ..CorrespondOptions::default() };
    if let Some(most) = args.form.settings.given.get("eigenfunctions") {
        options.eigenfunctions = most;
    }
    let shapes = expand(&args.meshes)?;
    match &shapes[..] {
        [] | [_] => bail!("a map joins two meshes, but there is only {}; name a second one", shapes.len()),
        [a, b] => pair::match_pair([&a.path, &b.path], args, common, options),
        _ => collection::match_all(&shapes, args, common, &options),
    }
}
