//! Arguments of `canonform field`.

use std::path::PathBuf;

use canonform::fields::Finish;
use canonform::settings::{Geodesic, MarchingSettings};
use clap::{ArgGroup, Args, Subcommand};

use super::settings::RepairArgs;
use super::shared::{LimitArgs, counted};

#[derive(Debug, Subcommand)]
pub(crate) enum FieldCommand {
    /// Measure distances from landmarks, from which all pairs follow with bounds
    Build(FieldBuildArgs),
    /// Look up distances of pairs, whole rows, or the nearest vertices
    Query(FieldQueryArgs),
    /// Report how a field was built
    Info {
        /// The field
        field: PathBuf,
    },
}

/// What the choice of the method means.
const METHODS: &str = "\
Every distance comes with an interval, lower <= distance <= upper. With --method exact the interval is certified: the true
distance along the surface cannot lie outside. That takes about four times as long. With other methods the interval is
measured: four columns are exact, and twice the largest error of the method in them widens all intervals.

Examples:
  canonform field build cat.off -o cat.field
  canonform field build cat.off --method exact --landmarks 200 -o cat.field";

#[derive(Debug, Args)]
#[command(after_long_help = METHODS, after_help = "See `--help-all` for what the method means for the bounds.")]
pub(crate) struct FieldBuildArgs {
    /// Mesh file, or `-` for standard input
    pub(crate) mesh: PathBuf,
    /// Output file
    #[arg(short, long, value_name = "FIELD")]
    pub(crate) output: PathBuf,
    /// Number of landmarks; each takes 2 bytes per vertex
    #[arg(long, default_value_t = 100, value_name = "N")]
    pub(crate) landmarks: usize,
    /// Number of eigenpairs behind the estimates; each takes 2 bytes per vertex [default: half the landmarks]
    #[arg(long, value_name = "R")]
    pub(crate) rank: Option<usize>,
    /// How to measure distances; only `exact` certifies the bounds
    #[arg(long, default_value = "fast-marching")]
    pub(crate) method: Geodesic,
    #[command(flatten)]
    pub(crate) marching: MarchingSettings,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

/// How pairs are written, and what the answers mean.
const ANSWERS: &str = "\
A file of pairs has two vertex numbers in every line, separated by a comma or spaces; or it is a .npy array of two columns.
Vertices have the numbers of the mesh file, counted from 0.

An answer is `estimated`, `exact` (finished by propagation on the surface), or `dropped` if the repair dropped one of the
vertices; its distances are then infinite.

Examples:
  canonform field query cat.field --pairs pairs.csv -o distances.csv
  canonform field query cat.field --source 17 -o row.npy
  canonform field query cat.field --source 17 --nearest 10 --json";

#[derive(Debug, Args)]
#[command(after_long_help = ANSWERS, after_help = "See `--help-all` for how to write pairs, and for examples.")]
#[command(group(ArgGroup::new("wanted").args(["pairs", "source"]).required(true)))]
pub(crate) struct FieldQueryArgs {
    /// The field
    pub(crate) field: PathBuf,
    /// File of pairs of vertices, .csv, .txt or .npy, or `-` for text from standard input
    #[arg(long, value_name = "FILE")]
    pub(crate) pairs: Option<PathBuf>,
    /// Vertices; the distances from each to all vertices
    #[arg(long, value_name = "V[,V...]", value_delimiter = ',', value_parser = counted::<u32>)]
    pub(crate) source: Vec<u32>,
    /// Only the K vertices nearest to each source, exactly
    #[arg(long, value_name = "K", requires = "source")]
    pub(crate) nearest: Option<usize>,
    /// Finish a pair by exact propagation if its interval is wider than this share of the distance; `none` finishes no pair
    #[arg(long, value_name = "SHARE|none", value_parser = tolerance, default_value = "0.05")]
    pub(crate) tolerance: Finish,
    /// Write the answers to a file instead of printing them: .csv, or .npy with the columns a, b, distance, lower, upper
    #[arg(short, long, value_name = "FILE")]
    pub(crate) output: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

fn tolerance(text: &str) -> Result<Finish, String> {
    if text == "none" {
        return Ok(Finish::Never);
    }
    let share = text.parse().ok().filter(|share: &f64| *share >= 0.0);
    share
        .map(Finish::Beyond)
        .ok_or_else(|| format!("`{text}` is neither a share of the distance, such as 0.05, nor `none`"))
}
