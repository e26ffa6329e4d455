//! The machine and the time of a run, for its records.

use std::time::{SystemTime, UNIX_EPOCH};

/// Processor, worker threads and operating system.
pub(crate) fn described() -> String {
    let os = std::env::consts::OS;
    let threads = rayon::current_num_threads();
    format!(
        "{}, {threads} worker threads, {os}",
        processor().unwrap_or_else(|| std::env::consts::ARCH.to_owned())
    )
}

/// The model of the processor, if the system tells it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}

/// The date and time in UTC, to the minute.
pub(crate) fn now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    date(seconds)
}

fn date(seconds: u64) -> String {
    let [year, month, day] = civil(seconds / 86_400);
    let minutes = seconds / 60 % 1440;
    format!("{year:04}-{month:02}-{day:02} {:02}:{:02} UTC", minutes / 60, minutes % 60)
}

/// Year, month and day of a number of days after the first of January 1970, by the algorithm `civil_from_days` of Howard
/// Hinnant: years begin in March, so that the leap day is the last one.
fn civil(days: u64) -> [u64; 3] {
    let days = days + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let (day, month) = (day - (153 * month + 2) / 5 + 1, if month < 10 { month + 3 } else { month - 9 });
    [400 * era + year + u64::from(month <= 2), month, day]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_know_leap_years() {
        assert_eq!(date(0), "1970-01-01 00:00 UTC");
        assert_eq!(date(951_782_399), "2000-02-28 23:59 UTC");
        assert_eq!(date(951_782_400), "2000-02-29 00:00 UTC");
        assert_eq!(date(4_107_542_400), "2100-03-01 00:00 UTC");
        assert_eq!(date(1_798_761_540), "2026-12-31 23:59 UTC");
    }

    #[test]
    fn the_machine_has_its_number_of_threads() {
        assert!(described().contains(&format!("{} worker threads", rayon::current_num_threads())));
    }
}
