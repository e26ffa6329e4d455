//! Reading meshes, and naming them in messages.

use std::path::Path;

use canonform::Surface;
use mesh::RepairReport;

use crate::args::RepairArgs;

/// Reports repairs on standard error; no repair is silent.
pub(crate) fn print_repair(name: &str, report: &RepairReport) {
    for line in report.summary() {
        terminal::note(&format!("{name}: {line}"));
    }
}

/// The name of a file in messages.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Reads and repairs a mesh, and reports repairs.
pub(crate) fn read_surface(path: &Path, repair: &RepairArgs) -> anyhow::Result<Surface> {
    let surface = Surface::read(path, &repair.options()).map_err(|fault| named(path, fault))?;
    print_repair(&file_name(path), &surface.repaired.report);
    Ok(surface)
}

/// An error that names the file exactly once.
pub(crate) fn named(path: &Path, fault: canonform::Error) -> anyhow::Error {
    let is_named = is_named(path, &fault.to_string());
    let error = anyhow::Error::from(fault);
    if is_named { error } else { error.context(path.display().to_string()) }
}

/// Whether a message names a mesh, by any of its files.
pub(crate) fn is_named(path: &Path, text: &str) -> bool {
    let mut files = mesh::io::files_of(path).into_iter().chain([path.to_owned()]);
    files.any(|file| text.contains(&file.display().to_string()))
}
