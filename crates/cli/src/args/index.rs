//! What `canonform index` is asked for.

use std::path::PathBuf;

use anyhow::Result;
use canonform::descriptors::{DescriptorError, Normalization};
use canonform::{DescribeOptions, Measure, Shard};
use clap::{Args, Subcommand};

use super::{Common, EmbeddingArgs};

#[derive(Debug, Args)]
pub(crate) struct IndexArgs {
    #[command(subcommand)]
    pub(crate) command: IndexCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum IndexCommand {
    /// Index every mesh in a folder; only what is new or has changed is described
    ///
    /// An interrupted run keeps what is done in INDEX.work; the same command goes on with it. Readers see the
    /// old index until the new one is finished. Meshes that cannot be read are listed at the end, and the exit
    /// code is then 2.
    Build(Box<BuildArgs>),
    /// Add meshes, or folders of them
    Add(AddArgs),
    /// Take shapes out
    Remove(RemoveArgs),
    /// Join indexes, for example those of shards, into one
    Merge(MergeArgs),
    /// Read every byte and every shape; exit with 2 if anything is not what was written
    Verify(OneIndexArgs),
    /// Say what an index holds
    Info(OneIndexArgs),
    /// Write an index as lines of JSON, the same however the index came about
    Export(ExportArgs),
}

#[derive(Debug, Args)]
pub(crate) struct BuildArgs {
    /// Folder of meshes. Classes come from sub-folders, else from the leading letters of file names
    #[arg(value_name = "DIR")]
    pub(crate) folder: PathBuf,
    /// The index
    #[arg(short, long, value_name = "INDEX")]
    pub(crate) output: PathBuf,
    /// Classes, a file of lines `name,label`
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) labels: Option<PathBuf>,
    /// Index only the I-th of N even shares of the folder, for `merge`
    #[arg(long, value_name = "I/N")]
    pub(crate) shard: Option<Shard>,
    #[command(flatten)]
    pub(crate) describe: DescribeArgs,
}

/// How shapes are described.
#[derive(Debug, Clone, Args)]
pub(crate) struct DescribeArgs {
    /// Number of points of a form to keep for alignment [default: 1000]
    #[arg(long)]
    pub(crate) points: Option<usize>,
    /// Let size count: all meshes have the same unit of length
    #[arg(long)]
    pub(crate) size: bool,
    #[command(flatten)]
    pub(crate) embedding: EmbeddingArgs,
}

impl DescribeArgs {
    pub(crate) fn options(&self, common: &Common) -> Result<DescribeOptions> {
        Ok(DescribeOptions {
            form: self.embedding.options(common)?,
            points: self.points.unwrap_or(DescribeOptions::default().points),
            size: if self.size { Normalization::Raw } else { Normalization::UnitArea },
        })
    }
}

#[derive(Debug, Args)]
pub(crate) struct AddArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Meshes, or folders of them
    #[arg(required = true, value_name = "MESH|DIR")]
    pub(crate) meshes: Vec<PathBuf>,
    /// Class of all of them [default: from their names]
    #[arg(long, value_name = "CLASS", conflicts_with = "labels")]
    pub(crate) label: Option<String>,
    /// Classes, a file of lines `name,label`
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) labels: Option<PathBuf>,
    /// Let them take the place of other shapes of the same names
    #[arg(long)]
    pub(crate) replace: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RemoveArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Names of shapes
    #[arg(required = true, value_name = "ID")]
    pub(crate) ids: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct MergeArgs {
    /// The indexes
    #[arg(required = true, value_name = "INDEX")]
    pub(crate) inputs: Vec<PathBuf>,
    /// The index of all their shapes
    #[arg(short, long, value_name = "INDEX")]
    pub(crate) output: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct OneIndexArgs {
    /// The index
    pub(crate) index: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Where to write [default: standard output]
    #[arg(short, long, value_name = "FILE.jsonl")]
    pub(crate) output: Option<PathBuf>,
}

#[derive(Debug, Args)]
pub(crate) struct SearchArgs {
    /// The index
    pub(crate) index: PathBuf,
    /// Meshes to look for
    #[arg(required = true, value_name = "QUERY")]
    pub(crate) queries: Vec<PathBuf>,
    /// Shapes wanted
    #[arg(short, default_value_t = 10)]
    pub(crate) k: usize,
    /// Say of every shape what kind of match it is
    #[arg(long)]
    pub(crate) explain: bool,
    /// Measure the signatures of all shapes, however many there are
    #[arg(long)]
    pub(crate) exact: bool,
}

#[derive(Debug, Args)]
pub(crate) struct EvaluateArgs {
    /// An index; or distances, one line of numbers separated by commas for each shape, perhaps below a line of
    /// names
    #[arg(value_name = "INDEX|MATRIX.csv")]
    pub(crate) input: PathBuf,
    /// Classes, a file of lines `name,label`; for a matrix without names in the order of its rows, as bare
    /// labels too [default: those of the index; from names]
    #[arg(long, value_name = "FILE")]
    pub(crate) labels: Option<PathBuf>,
    /// What distances are measured between, in an index: `fused`, `moments`, `d2`, `geodesic-spectrum`,
    /// `shape-dna`, `heat-kernel` or `wave-kernel`
    #[arg(long, value_name = "SIGNATURE", default_value = "fused", value_parser = parse_measure)]
    pub(crate) by: Measure,
    /// Neighbours that vote on the class of a shape
    #[arg(short, default_value_t = 1)]
    pub(crate) k: usize,
}

fn parse_measure(text: &str) -> Result<Measure, String> {
    match text {
        "fused" => Ok(Measure::Fused),
        kind => kind.parse().map(Measure::Signature).map_err(|fault: DescriptorError| fault.to_string()),
    }
}
