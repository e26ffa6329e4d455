//! Arguments of `canonform duplicates`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

const NOTES: &str = "\
Nothing is ever deleted. Every member of a group is compared with the file that is suggested to be kept, by the
triangles of both: `remeshed` and `noisy` say how surely. Exit code 0 with duplicates, 1 without.

Examples:
  canonform duplicates models/
  canonform duplicates shapes.canonform --csv duplicates.csv --html duplicates.html
  canonform duplicates models/ --kinds file,geometry";

#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub(crate) struct DuplicatesArgs {
    /// An index, or a dataset, which is described first
    #[arg(value_name = "INDEX|DIR")]
    pub(crate) input: PathBuf,
    /// Write one line per file
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Write a page with pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) html: Option<PathBuf>,
    /// What counts as a duplicate
    #[arg(
        long,
        value_name = "KIND,...",
        value_delimiter = ',',
        default_value = "file,geometry,scaled,mirrored,noisy,remeshed"
    )]
    pub(crate) kinds: Vec<KindArg>,
    /// The least confidence, 0 to 1
    #[arg(long, value_name = "P", default_value_t = 0.9)]
    pub(crate) min_confidence: f64,
}

/// A kind of relation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum KindArg {
    /// The same bytes
    File,
    /// The same vertices and faces
    Geometry,
    /// The same geometry at another size
    Scaled,
    /// The mirror image
    Mirrored,
    /// The same faces with noise
    Noisy,
    /// The same surface with other triangles
    Remeshed,
    /// Several copies in one file
    Copies,
    /// A component or a piece
    Part,
    /// The same part with another hole, thickness, length or detail
    Variant,
    /// The same shape in another pose
    Pose,
}
