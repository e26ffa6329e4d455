//! Progress on standard error: bars on a terminal, lines elsewhere.

use std::io::IsTerminal;
use std::sync::{LazyLock, Mutex, Once, PoisonError};
use std::time::Duration;

use indicatif::{MultiProgress, ProgressBar, ProgressDrawTarget, ProgressStyle, WeakProgressBar};

use super::notes::is_quiet;
use crate::{Budget, Observer, write_line};

/// One progress bar per stage, cleared on drop. If standard error is not a terminal, a line every few seconds takes the
/// place of the bar, so that a log shows progress and a short run prints nothing.
#[derive(Debug)]
pub struct Bars {
    visible: bool,
    budget: Budget,
    current: Mutex<Option<ProgressBar>>,
}

impl Bars {
    /// Bars that are hidden if `quiet`, or if the [program is](crate::terminal::set_quiet).
    pub fn new(quiet: bool) -> Self {
        Self::with_budget(quiet, Budget::unlimited())
    }

    /// Bars of work with this budget.
    pub fn with_budget(quiet: bool, budget: Budget) -> Self {
        Self { visible: !quiet && !is_quiet(), budget, current: Mutex::new(None) }
    }

    /// A bar over the steps of a stage, which the caller advances.
    pub fn bar(&self, stage: &str, total: usize) -> ProgressBar {
        if !self.visible {
            return ProgressBar::hidden();
        }
        if !std::io::stderr().is_terminal() {
            let bar = ProgressBar::with_draw_target(Some(total as u64), ProgressDrawTarget::hidden())
                .with_message(stage.to_owned());
            print_lines_of(&bar);
            return bar;
        }
        let style = ProgressStyle::with_template("{msg:>12} {wide_bar} {pos}/{len} {eta:>5} left");
        let bar = ON_TERMINAL.add(ProgressBar::new(total as u64).with_message(stage.to_owned()));
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
    fn budget(&self) -> Budget {
        self.budget.clone()
    }

    fn begin(&self, stage: &str, total: usize) {
        self.finish();
        *self.current.lock().unwrap_or_else(PoisonError::into_inner) = Some(self.bar(stage, total));
    }

    fn step(&self) {
        if let Some(bar) = self.current.lock().unwrap_or_else(PoisonError::into_inner).as_ref() {
            bar.set_position((bar.position() + 1).min(bar.length().unwrap_or(u64::MAX)));
        }
    }
}

/// The bars on the terminal, one below the other: two shapes may be worked on at a time.
static ON_TERMINAL: LazyLock<MultiProgress> = LazyLock::new(MultiProgress::new);

/// Time between two lines of progress.
const INTERVAL: Duration = Duration::from_secs(5);

/// The bars that are shown as lines.
static LINES: Mutex<Vec<WeakProgressBar>> = Mutex::new(Vec::new());

/// Writes the state of a bar to standard error every few seconds until it is finished or dropped. One thread does so for
/// all bars.
fn print_lines_of(bar: &ProgressBar) {
    static PRINTER: Once = Once::new();
    let mut bars = LINES.lock().unwrap_or_else(PoisonError::into_inner);
    bars.retain(|bar| unfinished(bar).is_some());
    bars.push(bar.downgrade());
    drop(bars);
    PRINTER.call_once(|| {
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(INTERVAL);
                let bars = LINES.lock().unwrap_or_else(PoisonError::into_inner);
                bars.iter().filter_map(unfinished).for_each(|bar| write_line(&line(&bar)));
            }
        });
    });
}

fn unfinished(bar: &WeakProgressBar) -> Option<ProgressBar> {
    bar.upgrade().filter(|bar| !bar.is_finished())
}

/// `distances: 40 of 100, 12 s, about 18 s left`.
fn line(bar: &ProgressBar) -> String {
    let (done, total, elapsed) = (bar.position(), bar.length().unwrap_or(0), bar.elapsed());
    let mut text = bar.message();
    if total > 1 {
        text += &format!(": {done} of {total}");
    }
    text += &format!(", {} s", elapsed.as_secs());
    if done > 0 && done < total {
        let left = elapsed.as_secs_f64() / done as f64 * (total - done) as f64;
        text += &format!(", about {} s left", left.round());
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_tell_what_is_done_and_what_is_left() {
        let bar = |total, done| {
            let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::hidden());
            let bar = bar.with_message("distances").with_elapsed(Duration::from_secs(12));
            bar.set_position(done);
            line(&bar)
        };
        assert_eq!(bar(100, 40), "distances: 40 of 100, 12 s, about 18 s left");
        assert_eq!(bar(100, 0), "distances: 0 of 100, 12 s");
        assert_eq!(bar(1, 0), "distances, 12 s");
    }

    #[test]
    fn lines_end_with_the_bar() {
        let bars = Bars::new(false);
        bars.begin("stage", 3);
        let weak = bars.current.lock().unwrap().as_ref().unwrap().downgrade();
        (0..4).for_each(|_| bars.step());
        assert!(line(&unfinished(&weak).unwrap()).starts_with("stage: 3 of 3, "));
        bars.finish();
        assert!(unfinished(&weak).is_none());
    }
}
