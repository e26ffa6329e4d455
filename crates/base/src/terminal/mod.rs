//! What the programs share: messages, progress, threads, interruption, exit codes.
//!
//! Knows nothing of arguments or results.

mod memory;
mod notes;
mod progress;

use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};

pub use memory::{memory_limit, with_peak_bytes};
pub use notes::{error, is_quiet, note, set_quiet};
pub use progress::Bars;

/// Called on the first interruption instead of exiting.
static ON_INTERRUPTION: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// Calls `stop` when the program is interrupted or terminated for the first time, so that it can end in an orderly way. The
/// second time it exits at once.
pub fn on_interruption(stop: impl FnOnce() + Send + 'static) {
    *ON_INTERRUPTION.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(stop));
}

/// Exit code after an interruption, by the convention of shells: 128 plus the number of the signal.
const INTERRUPTED: i32 = 130;

/// Runs a program on `threads` worker threads (0 for all cores) and returns its exit code, or prints its error to standard
/// error and returns 2. A closed output pipe is not an error.
///
/// Leaves no unfinished files behind when interrupted (Ctrl-C) or terminated; see also [`on_interruption`].
pub fn run(threads: usize, program: impl FnOnce() -> Result<ExitCode>) -> ExitCode {
    let interruption = ctrlc::set_handler(|| {
        if let Some(stop) = ON_INTERRUPTION.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return stop();
        }
        crate::files::abandon_unfinished();
        crate::write_line("interrupted");
        std::process::exit(INTERRUPTED);
    });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    let ready = interruption
        .context("cannot install the signal handler")
        .and_then(|()| pool.context("cannot start the worker threads"));
    match ready.and_then(|()| program()) {
        Ok(code) => code,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            notes::error(&message(&error));
            ExitCode::from(2)
        }
    }
}

/// An error and its causes, without causes whose text is already quoted.
pub fn message(error: &anyhow::Error) -> String {
    let mut text = String::new();
    for cause in error.chain().map(ToString::to_string) {
        if !text.contains(&cause) {
            if !text.is_empty() {
                text += ": ";
            }
            text += &cause;
        }
    }
    text
}

fn is_closed_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quoted_cause_is_not_repeated() {
        let cause = std::io::Error::other("no such file");
        let error = anyhow::Error::from(cause).context("cannot read a.off: no such file; check the path");
        assert_eq!(message(&error), "cannot read a.off: no such file; check the path");
        let error = anyhow::anyhow!("the reason").context("the work");
        assert_eq!(message(&error), "the work: the reason");
    }

    #[test]
    fn a_closed_pipe_is_recognized_below_its_context() {
        let pipe = std::io::Error::from(std::io::ErrorKind::BrokenPipe);
        assert!(is_closed_pipe(&anyhow::Error::from(pipe).context("writing")));
        assert!(!is_closed_pipe(&anyhow::anyhow!("something else")));
    }
}
