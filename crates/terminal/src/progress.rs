//! Progress bars on standard error.

use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};

use canonform::Observer;
use indicatif::{ProgressBar, ProgressStyle};

/// One progress bar per stage, shown only on a terminal, and cleared on drop.
#[derive(Debug)]
pub struct Bars {
    visible: bool,
    current: Mutex<Option<ProgressBar>>,
}

impl Bars {
    /// Bars that are hidden if `quiet`, or if standard error is not a terminal.
    #[must_use]
    pub fn new(quiet: bool) -> Self {
        Self { visible: !quiet && std::io::stderr().is_terminal(), current: Mutex::new(None) }
    }

    /// A bar over the steps of a stage, which the caller advances.
    #[must_use]
    pub fn bar(&self, stage: &str, total: usize) -> ProgressBar {
        if !self.visible {
            return ProgressBar::hidden();
        }
        let style = ProgressStyle::with_template("{msg:>12} {wide_bar} {pos}/{len} {eta:>5} left");
        let bar = ProgressBar::new(total as u64).with_message(stage.to_owned());
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar
    }

    /// Clears the current bar.
    pub fn finish(&self) {
        if let Some(bar) = self.current.lock().unwrap_or_else(PoisonError::into_inner).take() {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Bars {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Observer for Bars {
    fn begin(&self, stage: &str, total: usize) {
        self.finish();
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.bar(stage, total));
    }

    fn step(&self) {
        if let Some(bar) = self.current.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            bar.inc(1);
        }
    }
}
