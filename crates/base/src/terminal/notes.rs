//! Messages on standard error.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::write_line;

static QUIET: AtomicBool = AtomicBool::new(false);

/// Hides all messages but errors, for the rest of the program.
pub fn set_quiet(quiet: bool) {
    QUIET.store(quiet, Ordering::Relaxed);
}

/// Whether all messages but errors are hidden.
pub fn is_quiet() -> bool {
    QUIET.load(Ordering::Relaxed)
}

/// Writes a line to standard error, unless the program is [quiet](set_quiet).
pub fn note(text: &str) {
    if !is_quiet() {
        write_line(text);
    }
}

/// Writes an error to standard error.
pub fn error(text: &str) {
    write_line(&format!("error: {text}"));
}
