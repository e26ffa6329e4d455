//! Options that several commands share.

use std::str::FromStr;
use std::time::Duration;

use base::Budget;
use canonform::library::ShapeLimits;
use clap::Args;
use clap::builder::PossibleValuesParser;

/// Options of every command, listed after its own.
#[derive(Debug, Clone, Args)]
#[command(next_display_order = 900)]
pub(crate) struct Common {
    /// Print one JSON object to standard output and nothing else
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Print all facts, not only the most important ones
    #[arg(long, global = true)]
    pub(crate) details: bool,
    /// Number of worker threads, 0 for all cores; results do not depend on it
    #[arg(long, global = true, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=MOST_THREADS))]
    pub(crate) threads: u16,
    /// Seed for everything random
    #[arg(long, global = true, default_value_t = 0, value_name = "S")]
    pub(crate) seed: u64,
    /// Format of a mesh from standard input, the mesh `-`; for `embed` without `-`, the format of forms in a folder
    #[arg(long, global = true, value_name = "EXT")]
    pub(crate) format: Option<String>,
    /// The same, where --format means something else
    #[arg(long, global = true, value_name = "EXT", value_parser = input_format(), hide_short_help = true)]
    pub(crate) input_format: Option<String>,
    /// Write nothing but errors to standard error: no progress, no notes on repairs
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

/// What a text was read as, or the error that it is not `what`.
pub(super) fn read<T>(text: &str, found: Option<T>, what: &str) -> Result<T, String> {
    found.ok_or_else(|| format!("`{text}` is not {what}"))
}

/// Reads the number of a vertex or a row.
pub(super) fn counted<T: FromStr>(text: &str) -> Result<T, String> {
    read(text, text.parse().ok(), "a whole number, counted from 0")
}

/// More threads than this do not help on any machine, and starting them may fail.
const MOST_THREADS: i64 = 1024;

/// The extensions of formats that hold a mesh in one file.
fn input_format() -> PossibleValuesParser {
    let single = canonform::mesh::io::FORMATS.iter().filter(|format| format.extensions.len() == 1);
    PossibleValuesParser::new(single.map(|format| format.extensions[0]))
}

/// Limits on what a command may use. Flatten it last.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct LimitArgs {
    /// Stop with an error after this many seconds; with several meshes, this applies to each of them
    #[arg(long, help_heading = "Limits", value_name = "SECONDS", value_parser = parse_seconds)]
    pub(crate) timeout: Option<Duration>,
    /// Most memory for distances and matrices, in bytes or with K, M, G or T. Beyond it, embed keeps distances in a temporary
    /// file beside its output; other commands, and embed if that is not enough, stop with an error
    #[arg(long, help_heading = "Limits", value_name = "BYTES", value_parser = parse_bytes)]
    pub(crate) memory: Option<usize>,
}

impl LimitArgs {
    /// A budget that starts now.
    pub(crate) fn budget(&self) -> Budget {
        self.each(None).budget(Budget::unlimited())
    }

    /// The limits of each of several shapes.
    pub(crate) fn each(&self, max_vertices: Option<u64>) -> ShapeLimits {
        ShapeLimits { max_vertices, time: self.timeout, memory: self.memory }
    }
}

/// A time limit in seconds, also a fraction.
fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    read(text, limit, "a time limit; give a positive number of seconds, such as 60")
}

/// A number of bytes; K, M, G and T are powers of 1024.
pub(super) fn parse_bytes(text: &str) -> Result<usize, String> {
    let (number, unit) = text.split_at(text.find(|c: char| !c.is_ascii_digit()).unwrap_or(text.len()));
    let unit = unit.to_ascii_uppercase();
    let unit = unit.trim_end_matches("IB").trim_end_matches('B');
    let power = ["", "K", "M", "G", "T"].iter().position(|known| *known == unit);
    let number = number.parse::<usize>().ok().zip(power);
    let bytes = number.and_then(|(number, power)| number.checked_mul(1 << (10 * power)));
    read(text, bytes, "a memory size; write for example 800M or 2G")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn memory_sizes_are_read_with_and_without_units() {
        for (text, bytes) in [("0", 0), ("4096", 4096), ("3k", 3 << 10), ("2M", 2 << 20), ("1G", 1 << 30)] {
            assert_eq!(parse_bytes(text), Ok(bytes));
        }
        assert_eq!(parse_bytes("7GB"), parse_bytes("7GiB"));
        for text in ["", "G", "-1", "1.5G", "1X", "9999999999999999T"] {
            assert!(parse_bytes(text).is_err(), "{text}");
        }
    }
}
