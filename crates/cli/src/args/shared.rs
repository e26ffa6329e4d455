//! Options that several commands share.

use std::time::Duration;

use budget::Budget;
use canonform::geodesics::{FastMarchingOptions, Method, ObtuseTreatment, Update};
use canonform::{FormOptions, Samples, StressChoice};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mesh::{ComponentPolicy, Orient, RepairOptions, Weld};

/// Options of every command.
#[derive(Debug, Clone, Args)]
pub(crate) struct Common {
    /// Print one JSON object to standard output and nothing else
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Number of worker threads, 0 for all cores; results do not depend on it
    #[arg(long, global = true, default_value_t = 0, value_name = "N", value_parser = threads())]
    pub(crate) threads: u16,
    /// Seed for everything random
    #[arg(long, global = true, default_value_t = 0, value_name = "S")]
    pub(crate) seed: u64,
    /// Format of a mesh from standard input, which the mesh argument `-` stands for; without `-`, for `embed`, the format
    /// of forms in a folder
    #[arg(long, global = true, value_name = "EXT")]
    pub(crate) format: Option<String>,
    /// The same, where --format means something else
    #[arg(long, global = true, value_name = "EXT", value_parser = input_format())]
    pub(crate) input_format: Option<&'static str>,
    /// Write nothing but errors to standard error: no progress, no notes on repairs
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

impl Common {
    /// The format of standard input, if it is known.
    pub(crate) fn stream_format(&self) -> Option<&str> {
        self.input_format.or(self.format.as_deref())
    }

    /// What `--format` says about the output: nothing if it is the format of the input.
    pub(crate) fn format_of_output(&self, reads_stream: bool) -> Option<&str> {
        self.format.as_deref().filter(|_| !reads_stream || self.input_format.is_some())
    }
}

/// More threads than this do not help on any machine, and starting them may fail.
const MOST_THREADS: i64 = 1024;

fn threads() -> clap::builder::RangedI64ValueParser<u16> {
    clap::value_parser!(u16).range(0..=MOST_THREADS)
}

/// The extensions of formats that hold a mesh in one file.
fn input_format() -> impl TypedValueParser<Value = &'static str> {
    let single = || mesh::io::FORMATS.iter().filter(|format| format.extensions.len() == 1);
    PossibleValuesParser::new(single().map(|format| format.extensions[0])).try_map(move |chosen| {
        let found = single().find(|format| format.extensions[0] == chosen);
        found.map(|format| format.extensions[0]).ok_or_else(|| format!("`{chosen}` is unknown"))
    })
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
        let budget =
            self.timeout.map_or_else(Budget::unlimited, |limit| Budget::unlimited().with_time(limit));
        match self.memory {
            Some(bytes) => budget.with_memory(bytes),
            None => budget,
        }
    }
}

/// A time limit in seconds, also a fraction.
fn parse_seconds(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| *seconds > 0.0);
    let limit = seconds.and_then(|seconds| Duration::try_from_secs_f64(seconds).ok());
    limit
        .ok_or_else(|| format!("`{text}` is not a time limit; give a positive number of seconds, such as 60"))
}

/// A number of bytes; K, M, G and T are powers of 1024.
pub(super) fn parse_bytes(text: &str) -> Result<usize, String> {
    let wrong = || format!("`{text}` is not a memory size; write for example 800M or 2G");
    let (number, unit) = match text.find(|c: char| !c.is_ascii_digit()) {
        Some(end) => text.split_at(end),
        None => (text, ""),
    };
    let power = match unit.to_ascii_uppercase().trim_end_matches("IB").trim_end_matches('B') {
        "" => 0,
        "K" => 1,
        "M" => 2,
        "G" => 3,
        "T" => 4,
        _ => return Err(wrong()),
    };
    let number: usize = number.parse().map_err(|_| wrong())?;
    number.checked_mul(1 << (10 * power)).ok_or_else(wrong)
}

/// How meshes are repaired before anything is measured.
#[derive(Debug, Clone, Args)]
pub(crate) struct RepairArgs {
    /// What to do with a mesh of several components
    #[arg(long, help_heading = "Repair", value_parser = components(), default_value = "largest", value_name = "POLICY")]
    pub(crate) components: ComponentPolicy,
    /// Which vertices to merge: `seams` on boundaries (the default), `all`, `none`, or a distance
    ///
    /// `seams` merges boundary vertices in the same position, and boundary edges that nearly coincide: those whose ends
    /// are within 2 % of the shortest side of their faces. A number merges boundary vertices within this distance, in mesh
    /// units. `all` merges all vertices in the same position. Two vertices of one edge are never merged.
    #[arg(long, help_heading = "Repair", value_parser = weld, default_value = "seams", value_name = "seams|all|none|TOL")]
    pub(crate) weld: Weld,
    /// Exit with code 1 if more than this share of the surface is dropped; results are still written
    #[arg(long, help_heading = "Repair", value_parser = share, default_value_t = MAX_DROPPED, value_name = "SHARE")]
    pub(crate) max_dropped: f64,
}

/// The share of a surface that a repair may drop by default.
pub(crate) const MAX_DROPPED: f64 = 0.01;

fn share(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| format!("`{text}` is not a share of the surface; give a number from 0 to 1"))
}

fn components() -> impl TypedValueParser<Value = ComponentPolicy> {
    one_of([
        ("largest", "Keep the component with the largest area", ComponentPolicy::Largest),
        ("bridge", "Join the components by links, all along narrow gaps", ComponentPolicy::Bridge),
        ("error", "Refuse the mesh", ComponentPolicy::Error),
    ])
}

fn weld(text: &str) -> Result<Weld, String> {
    let tolerance = || {
        let tolerance =
            text.parse().ok().filter(|tolerance: &f64| tolerance.is_finite() && *tolerance >= 0.0);
        tolerance.map(Weld::Within).ok_or_else(|| {
            format!("`{text}` is neither `seams`, `all` or `none` nor a distance in mesh units")
        })
    };
    match text {
        "none" => Ok(Weld::None),
        "seams" => Ok(Weld::Seams),
        "all" => Ok(Weld::All),
        _ => tolerance(),
    }
}

impl RepairArgs {
    pub(crate) fn options(&self) -> RepairOptions {
        RepairOptions { components: self.components, weld: self.weld, orient: Orient::Keep }
    }
}

/// Options of fast marching.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct MarchingArgs {
    /// Local solver
    #[arg(long, help_heading = "Fast marching", value_parser = update(), default_value = "point-source")]
    pub(crate) update: Update,
    /// What to do about angles wider than 90 degrees
    #[arg(long, help_heading = "Fast marching", value_parser = obtuse(), default_value = "flip")]
    pub(crate) obtuse: ObtuseTreatment,
}

fn update() -> impl TypedValueParser<Value = Update> {
    one_of([
        ("point-source", "The front in a triangle comes from one point (fastest)", Update::PointSource),
        (
            "virtual-source",
            "Triangles hand on where the source lies in their plane (most accurate)",
            Update::VirtualSource,
        ),
        ("planar", "The front in a triangle is a straight line (Kimmel and Sethian)", Update::Planar),
    ])
}

fn obtuse() -> impl TypedValueParser<Value = ObtuseTreatment> {
    one_of([
        ("flip", "Flip interior edges until few are left", ObtuseTreatment::Flip),
        (
            "unfold",
            "Unfold the surface across the angle and split it (Kimmel and Sethian)",
            ObtuseTreatment::Unfold,
        ),
        ("ignore", "Treat them like any other", ObtuseTreatment::Ignore),
    ])
}

impl MarchingArgs {
    /// A method, with these options if it is fast marching.
    pub(crate) fn of(self, method: Method) -> Method {
        let Self { update, obtuse } = self;
        match method {
            Method::FastMarching(_) => Method::FastMarching(FastMarchingOptions { update, obtuse }),
            other => other,
        }
    }
}

/// The options of every embedding. Flatten it last: its help heading applies to all options that follow.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Embedding")]
pub(crate) struct FormArgs {
    /// Number of samples, or `auto` to take as many as needed [default: 100]
    #[arg(short = 'n', long, value_name = "SAMPLES|auto")]
    pub(crate) samples: Option<Samples>,
    /// Dimensions of the embedding
    #[arg(long, default_value_t = 3, value_name = "K")]
    pub(crate) dim: usize,
    /// How to measure distances
    #[arg(long, value_parser = distance_method(), default_value = Method::default().name(), value_name = "METHOD")]
    pub(crate) geodesic: Method,
    #[command(flatten)]
    pub(crate) marching: MarchingArgs,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

impl FormArgs {
    /// These options, with the default method and sampling.
    pub(crate) fn options(&self, common: &Common) -> FormOptions {
        FormOptions {
            repair: self.repair.options(),
            geodesic: self.marching.of(self.geodesic),
            samples: self.samples.unwrap_or_default(),
            dim: self.dim,
            seed: common.seed,
            ..FormOptions::default()
        }
    }
}

/// How to find the stress of an embedding.
pub(crate) const STRESS: [(&str, &str, StressChoice); 4] = [
    (
        "auto",
        "Exactly up to 1,000 vertices, beyond from one row for every 5 samples, at least 3, or 32 with -n auto",
        StressChoice::Auto,
    ),
    ("exact", "From the distances between all pairs of vertices", StressChoice::Exact),
    ("estimate", "From the distances of 100 vertices to all others", StressChoice::Estimate),
    ("skip", "Not at all", StressChoice::Skip),
];

/// How to find it when methods are compared.
pub(crate) const COMPARED_STRESS: (&str, &str, StressChoice) =
    ("auto", "Exactly up to 5,000 vertices, beyond from 100 vertices to all others", StressChoice::Auto);

/// Reads values by their names, each with a line of help.
pub(crate) fn one_of<T: Clone + Send + Sync + 'static, const N: usize>(
    values: [(&'static str, &'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let possible = values.each_ref().map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(possible).try_map(move |chosen| {
        let found = values.iter().find(|(name, ..)| *name == chosen);
        found.map(|(.., value)| value.clone()).ok_or_else(|| format!("`{chosen}` is unknown"))
    })
}

/// Reads a distance method by its name.
pub(crate) fn distance_method() -> impl TypedValueParser<Value = Method> {
    one_of(Method::all().map(|m| (m.name(), m.summary(), m)))
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

    #[test]
    fn time_limits_are_positive_seconds() {
        assert_eq!(parse_seconds("0.5"), Ok(Duration::from_millis(500)));
        for text in ["", "0", "-1", "nan", "inf", "1e300", "1m"] {
            assert!(parse_seconds(text).unwrap_err().contains("positive number of seconds"), "{text}");
        }
    }
}
