//! Reading meshes, and naming them in messages.

use std::path::Path;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};

use canonform::{Remedy, Surface};
use mesh::RepairReport;

use crate::args::RepairArgs;
use crate::remedy::with_remedy;

/// Whether a mesh lost more of its surface than allowed.
static LOST_TOO_MUCH: AtomicBool = AtomicBool::new(false);

/// Reports repairs on standard error; no repair is silent.
pub(crate) fn print_repair(name: &str, report: &RepairReport, args: &RepairArgs) {
    for line in report.summary() {
        terminal::note(&format!("{name}: {line}"));
    }
    check_dropped(name, report.dropped_area_share, args.max_dropped);
}

/// Warns if more of the surface of a shape was dropped than allowed, and then makes the program
/// [exit with code 1](exit_code_of).
pub(crate) fn check_dropped(name: &str, share: f64, allowed: f64) {
    if share > allowed {
        LOST_TOO_MUCH.store(true, Ordering::Relaxed);
        let message = format!(
            "{name}: {:.1} % of the surface was dropped, since it is not connected to the rest; {:.1} % is allowed",
            100.0 * share,
            100.0 * allowed
        );
        eprintln!("warning: {}", with_remedy(message, Some(Remedy::BridgeOrWeld)));
    }
}

/// The exit code of a command that ended with this one.
pub(crate) fn exit_code_of(code: ExitCode) -> ExitCode {
    let lost = LOST_TOO_MUCH.load(Ordering::Relaxed);
    if lost && code == ExitCode::SUCCESS { ExitCode::from(1) } else { code }
}

/// The name of a file in messages.
pub(crate) fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// Reads and repairs a mesh, and reports repairs.
pub(crate) fn read_surface(path: &Path, repair: &RepairArgs) -> anyhow::Result<Surface> {
    let surface = Surface::read(path, &repair.options()).map_err(|fault| named(path, fault))?;
    print_repair(&file_name(path), &surface.repaired.report, repair);
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
