//! One file a command.

mod compare;
mod completions;
mod embed;
mod evaluate;
mod geodesic;
mod index;
mod info;
mod methods;
mod render;
mod search;
mod serve;

pub(crate) use compare::compare;
pub(crate) use completions::completions;
pub(crate) use embed::embed;
pub(crate) use evaluate::evaluate;
pub(crate) use geodesic::geodesic;
pub(crate) use index::index;
pub(crate) use info::info;
pub(crate) use methods::methods;
pub(crate) use render::picture;
pub(crate) use search::search;
pub(crate) use serve::serve;

use canonform::Surface;
use mesh::RepairReport;

/// Says on standard error what was repaired; a repair is never silent.
fn say_repair(name: &str, report: &RepairReport) {
    for line in report.summary() {
        eprintln!("{name}: {line}");
    }
}

/// How a path is named in messages.
fn file_name(path: &std::path::Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Reads and repairs a mesh and says what was repaired.
fn read_surface(path: &std::path::Path, repair: &crate::args::RepairArgs) -> anyhow::Result<Surface> {
    let surface = Surface::read(path, &repair.options()).map_err(|fault| named(path, fault))?;
    say_repair(&file_name(path), &surface.repaired.report);
    Ok(surface)
}

/// An error that names the file once, whether or not it does so itself.
fn named(path: &std::path::Path, fault: canonform::Error) -> anyhow::Error {
    let is_named = is_named(path, &fault.to_string());
    let error = anyhow::Error::from(fault);
    if is_named { error } else { error.context(path.display().to_string()) }
}

/// Whether a message names a file.
fn is_named(path: &std::path::Path, text: &str) -> bool {
    // Of a `.vert`/`.tri` pair the fault may lie in the other half.
    let names = [path.to_owned(), path.with_extension("vert"), path.with_extension("tri")];
    names.iter().any(|name| text.contains(&name.display().to_string()))
}
