//! What the programs share towards the person at the terminal: progress, threads, interruption, exit codes.
//!
//! Knows nothing of arguments or results.

mod progress;

use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

use anyhow::{Context, Result};

pub use progress::Bars;

/// What to do when the program is interrupted for the first time, instead of ending at once.
static INSTEAD: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// Has `stop` called when the program is interrupted or terminated, so that it can end by itself; the second time it ends
/// at once.
pub fn on_interruption(stop: impl FnOnce() + Send + 'static) {
    *INSTEAD.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(stop));
}

/// Exit code of a program that was interrupted, as shells know it: 128 and the number of the signal.
const INTERRUPTED: i32 = 130;

/// Runs a program on `threads` worker threads (0 for all cores) and turns its result into an exit code:
/// its own, or 2 with the error on standard error. That nobody reads the output any more is no error.
///
/// When it is interrupted (Ctrl-C) or terminated, nothing half-written is left behind; see also
/// [`on_interruption`].
pub fn run(threads: usize, program: impl FnOnce() -> Result<ExitCode>) -> ExitCode {
    let interruption = ctrlc::set_handler(|| {
        if let Some(stop) = INSTEAD.lock().unwrap_or_else(PoisonError::into_inner).take() {
            return stop();
        }
        files::abandon_unfinished();
        eprintln!("interrupted");
        std::process::exit(INTERRUPTED);
    });
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build_global();
    let ready = interruption
        .context("cannot prepare for interruption")
        .and_then(|()| pool.context("cannot start the worker threads"));
    match ready.and_then(|()| program()) {
        Ok(code) => code,
        Err(error) if is_closed_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {}", message(&error));
            ExitCode::from(2)
        }
    }
}

/// An error and its causes, without those that an error before them has quoted already.
#[must_use]
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
    fn a_cause_that_was_quoted_is_not_said_again() {
        let cause = std::io::Error::other("no such file");
        let error = anyhow::Error::from(cause).context("cannot read a.off: no such file; check the path");
        assert_eq!(message(&error), "cannot read a.off: no such file; check the path");
        let error = anyhow::anyhow!("the reason").context("the work");
        assert_eq!(message(&error), "the work: the reason");
    }

    #[test]
    fn a_closed_pipe_is_recognised_beneath_its_context() {
        let pipe = std::io::Error::from(std::io::ErrorKind::BrokenPipe);
        assert!(is_closed_pipe(&anyhow::Error::from(pipe).context("writing")));
        assert!(!is_closed_pipe(&anyhow::anyhow!("something else")));
    }
}
