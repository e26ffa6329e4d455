//! Arguments of `canonform generate`.

use std::path::PathBuf;

use canonform::mesh::io::{Content, writable};
use clap::builder::PossibleValuesParser;
use clap::{Args, ValueEnum};

/// Where the shapes go.
const NOTES: &str = "\
Shapes of the families cat, centaur, david and person are written to FOLDER/NAME.EXT, creatures to FOLDER/CLASS/NAME.EXT,
and mechanical parts to FOLDER/FAMILY-PARAMETERS.EXT, such as gear-z18-m1-t5-d4.off. All are datasets for `canonform index
build`. The default seed gives the shapes of the experiments. Existing files are replaced. --vertices and --poses do not
concern mechanical parts.

Examples:
  canonform generate -o shapes/
  canonform generate --family cat --poses 3 --vertices 28000 -o cats/
  canonform generate --family creatures --classes 500 --poses 20 --vertices 1000 -o many/
  canonform generate --family parts --output-format stl -o parts/";

#[derive(Debug, Args)]
#[command(after_long_help = NOTES, after_help = "See `--help-all` for the names of the files, and for examples.")]
pub(crate) struct GenerateArgs {
    /// Folder to write the meshes into
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,
    /// Which shapes
    #[arg(long, value_enum, default_value_t = FamilyArg::All)]
    pub(crate) family: FamilyArg,
    /// Exact number of vertices of every shape, 1,000 to 1,000,000
    #[arg(long, value_name = "P", default_value_t = 3400)]
    pub(crate) vertices: usize,
    /// Shapes of each class [default: 9 cats, 6 centaurs, 15 davids, 8 people, 8 of each class of creatures]
    #[arg(long, value_name = "N")]
    pub(crate) poses: Option<usize>,
    /// Number of mechanical parts
    #[arg(long, value_name = "N", default_value_t = 112)]
    pub(crate) parts: usize,
    /// Segments of a full circle of mechanical parts
    #[arg(long, value_name = "N", default_value_t = 32)]
    pub(crate) arcs: usize,
    /// Number of classes of creatures
    #[arg(long, value_name = "N", default_value_t = 48)]
    pub(crate) classes: usize,
    /// Format of the files
    #[arg(long, value_name = "EXT", default_value = "off", value_parser = PossibleValuesParser::new(writable(Content::Mesh)))]
    pub(crate) output_format: String,
}

/// What `canonform generate` makes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FamilyArg {
    /// Cats, centaurs and davids: the built-in dataset
    All,
    /// Poses of a cat
    Cat,
    /// Poses of a centaur
    Centaur,
    /// Poses of a man
    David,
    /// Poses of a man whose front and back differ on every limb, on whom maps are judged
    Person,
    /// Random bodies of 28 kinds, from worms to scissors; each class is one body
    Creatures,
    /// Screws, brackets and other mechanical parts in millimetres, many of nearly the same size
    Parts,
}
