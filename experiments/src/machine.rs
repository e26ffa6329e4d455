//! The machine and the time of a run, for its records.

use std::time::SystemTime;

use chrono::{DateTime, Utc};

/// Processor, worker threads and operating system.
pub(crate) fn described() -> String {
    let os = std::env::consts::OS;
    let processor = processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let threads = rayon::current_num_threads();
    format!("{processor}, {threads} worker thread{}, {os}", if threads == 1 { "" } else { "s" })
}

/// The model of the processor, if the system tells it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The date and time in UTC, to the minute.
pub(crate) fn now() -> String {
    DateTime::<Utc>::from(SystemTime::now()).format("%Y-%m-%d %H:%M UTC").to_string()
}
