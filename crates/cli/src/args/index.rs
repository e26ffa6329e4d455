//! Arguments of the commands that read and write indexes.

use std::path::PathBuf;

use canonform::library::{Measure, ShapeLimits, Shard};
use canonform::retrieval::RankBy;
use canonform::search::SearchRank;
use canonform::settings::{DescriptionSettings, MethodSettings};
use clap::{Args, Subcommand};

use super::settings::FormArgs;
use super::shared::LimitArgs;

#[derive(Debug, Subcommand)]
pub(crate) enum IndexCommand {
    /// Index every mesh of a folder, an archive or a list; describe only new and changed ones
    ///
    /// Every described mesh is in the index at once: after an interruption, run the same command again to continue.
    /// Searches beside it see a whole state. Meshes that cannot be described are listed at the end, and the exit
    /// code is then 2. Shapes of the folder whose files are gone are removed; shapes that came from elsewhere stay
    /// (see --prune). Links are followed, but nothing is indexed twice through them.
    Build(Box<BuildArgs>),
    /// Add meshes, or datasets of them
    Add(AddArgs),
    /// Remove shapes
    Remove {
        /// The index
        index: PathBuf,
        /// Names of shapes
        #[arg(required = true, value_name = "ID")]
        ids: Vec<String>,
    },
    /// Merge indexes, for example those of shards, into one
    Merge {
        /// Indexes to merge
        #[arg(required = true, value_name = "INDEX")]
        inputs: Vec<PathBuf>,
        /// Output index
        #[arg(short, long, value_name = "INDEX")]
        output: PathBuf,
    },
    /// Check the structure and every value; exit with code 2 if the index is damaged
    Verify {
        /// The index
        index: PathBuf,
    },
    /// List the shapes of an index: names, classes and paths; exit with code 1 if there are none
    List(ListArgs),
    /// Report what an index contains
    Info {
        /// The index
        index: PathBuf,
    },
    /// Write an index as lines of JSON, Parquet, NumPy arrays or CSV, the same however the index was built
    ///
    /// .jsonl and .parquet hold everything, a row for every shape in the order of their names. .npz holds one array for every
    /// column. .csv holds names, classes, facts and the fused vector, which search compares.
    Export {
        /// The index
        index: PathBuf,
        /// Output file: .jsonl, .parquet, .npz or .csv, or `-` for standard output [default: -]
        #[arg(short, long, value_name = "FILE")]
        output: Option<PathBuf>,
        /// File format on standard output: jsonl, parquet, npz or csv [default: jsonl]
        #[arg(long, value_name = "EXT")]
        output_format: Option<String>,
    },
}

#[derive(Debug, Args)]
pub(crate) struct ListArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Only shapes of this class; may be repeated
    #[arg(long, value_name = "CLASS")]
    pub(crate) label: Vec<String>,
    /// Only shapes without a class, or also these with --label
    #[arg(long)]
    pub(crate) unlabelled: bool,
}

#[derive(Debug, Args)]
pub(crate) struct BuildArgs {
    /// Dataset: a folder of meshes, an archive (.zip, .tar, .tar.gz), a .parquet file with the columns id, label, format
    /// and bytes, or a .txt file with a path in every line
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// Output index
    #[arg(short, long, value_name = "INDEX")]
    pub(crate) output: PathBuf,
    /// Where classes come from: `folders`, `folders:N` (the N-th below the dataset), `names` (their leading letters), `none`, or a
    /// file of lines `name,label`
    ///
    /// The file need not name all shapes. By default, an index keeps the classes that were given; else sub-folders beside each other
    /// are classes if at least two hold at least two meshes each and none lies in another; else leading letters, if at least two
    /// names share them and not nearly all do.
    #[arg(long, value_name = "SOURCE")]
    pub(crate) labels: Option<PathBuf>,
    /// Remove the shapes that did not come from this folder, such as those that `index add` put in
    #[arg(long)]
    pub(crate) prune: bool,
    /// Index only the I-th of N equal parts of the folder, for `merge`
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    #[command(flatten)]
    pub(crate) description: DescriptionSettings,
    #[command(flatten)]
    pub(crate) method: MethodSettings,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) limits: BatchLimitArgs,
}

/// Limits on each of many shapes; the rest goes on when one exceeds them. Flatten it last.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct BatchLimitArgs {
    /// Leave out meshes with more vertices than this, or with more than four times as many faces
    #[arg(long, help_heading = "Limits", value_name = "N")]
    pub(crate) max_vertices: Option<u64>,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

impl BatchLimitArgs {
    /// Under `ulimit -v` each thread gets its share of half the memory: a shape beyond it would end the whole run.
    pub(crate) fn each(&self) -> ShapeLimits {
        let Self { max_vertices, limits } = *self;
        let share = || Some(base::terminal::memory_limit()? / 2 / rayon::current_num_threads());
        LimitArgs { memory: limits.memory.or_else(share), ..limits }.each(max_vertices)
    }
}

#[derive(Debug, Args)]
pub(crate) struct AddArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Meshes, or datasets: folders, archives and lists
    #[arg(required = true, value_name = "MESH|DIR")]
    pub(crate) meshes: Vec<PathBuf>,
    /// Class of all these meshes
    #[arg(long, value_name = "CLASS", conflicts_with = "labels")]
    pub(crate) label: Option<String>,
    /// Where classes come from, as for `build` [default: as for `build`; a single file has the class that its name begins
    /// with if the index knows it]
    #[arg(long, value_name = "SOURCE")]
    pub(crate) labels: Option<PathBuf>,
    /// Replace shapes that have the same name
    #[arg(long)]
    pub(crate) replace: bool,
    #[command(flatten)]
    pub(crate) limits: BatchLimitArgs,
}

/// What --json prints.
const SEARCH_JSON: &str = "\
With --json, `queries` holds the answer to each query and `failed` the queries that could not be read, for one
query as for many.";

#[derive(Debug, Args)]
#[command(after_help = SEARCH_JSON)]
pub(crate) struct SearchArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Meshes, datasets, `-` for standard input, or names of shapes in the index. A file goes before a shape of the same
    /// name
    #[arg(required_unless_present = "id", value_name = "MESH|DIR|ID")]
    pub(crate) queries: Vec<PathBuf>,
    /// Search with this shape of the index, even if a file has its name; may be repeated
    #[arg(long, value_name = "ID")]
    pub(crate) id: Vec<String>,
    /// Number of shapes to find; 0 predicts the class only
    #[arg(short, default_value_t = 10)]
    pub(crate) k: usize,
    /// Say how every shape is related to the query, as `compare` does; reads the files of the shapes again
    #[arg(long)]
    pub(crate) explain: bool,
    /// Accepted for older scripts: every search compares all shapes
    #[arg(long, hide = true)]
    pub(crate) exact: bool,
    /// How to order results; `part` and `forms` compare the query with every shape
    #[arg(long, alias = "by", default_value = "plain")]
    pub(crate) rank: SearchRank,
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// An index; or a distance matrix, one line of comma-separated numbers per shape, optionally below a line of names
    #[arg(value_name = "INDEX|MATRIX.csv")]
    pub(crate) input: PathBuf,
    /// Where classes come from, as for `index build`; for a matrix without names, a file of labels in the order of its rows
    /// [default: those of the index; for a matrix, from the names]
    #[arg(long, value_name = "SOURCE")]
    pub(crate) labels: Option<PathBuf>,
    /// Signatures of an index to measure distances between: `fused`, `form-spectrum`, `geodesic-spectrum`,
    /// `shape-dna`, `heat-kernel`, `wave-kernel` or `rigid`
    #[arg(long, value_name = "SIGNATURE", default_value = "fused")]
    pub(crate) by: Measure,
    /// Number of neighbors that vote on the class of a shape
    #[arg(short, default_value_t = 1)]
    pub(crate) k: usize,
    /// Rankings to score
    #[arg(long, default_value = "plain")]
    pub(crate) rank: RankBy,
}
