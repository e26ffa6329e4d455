//! Arguments of `canonform duplicates`.

use std::path::PathBuf;

use canonform::library::Keep;
use canonform::relations::RelationKind;
use clap::Args;
use clap::builder::TypedValueParser;

use super::settings::one_of;

const NOTES: &str = "\
Nothing is ever deleted. Every member of a group is compared with the file that is suggested to be kept, or with a member of
which it is an exact copy, by the triangles of both: `remeshed` and `noisy` say how surely. Exit code 0 with duplicates, 1
without.

By default, the most exact file is kept: without noise, with all detail, in the fewest vertices. Between equal ones, references
come first, then formats that lose nothing, folders in the order given, and the oldest.

--move-to moves copies of a file or of its geometry, with all files of their meshes, into FOLDER, which scans leave out from
then on. Links, what they lead to, files with several names and members of archives stay. A cell of the CSV that a spreadsheet
would take for a formula begins with an apostrophe.

Examples:
  canonform duplicates models/
  canonform duplicates models/ backup/ --reference master/
  canonform duplicates shapes.canonform --csv duplicates.csv --html duplicates.html
  canonform duplicates models/ --move-to duplicates/
  canonform duplicates --undo duplicates/canonform-moved.jsonl";

#[derive(Debug, Args)]
#[command(after_help = NOTES)]
pub(crate) struct DuplicatesArgs {
    /// An index, or datasets and meshes, which are described first
    #[arg(value_name = "INDEX|DIR", required_unless_present_any = ["undo", "reference"])]
    pub(crate) inputs: Vec<PathBuf>,
    /// Compare with this folder or archive, too, and never suggest to remove or move anything from it; may be repeated
    #[arg(long, value_name = "DIR")]
    pub(crate) reference: Vec<PathBuf>,
    /// Which file of a group is kept: `exact`, `largest`, `smallest`, `oldest`, `newest`, or one in a folder
    #[arg(long, value_name = "WHICH|DIR", default_value = "exact")]
    pub(crate) keep: Keep,
    /// Write one line per file
    #[arg(long, value_name = "FILE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Write a page with pictures
    #[arg(long, value_name = "FILE.html")]
    pub(crate) html: Option<PathBuf>,
    /// Move proved copies out of the folders into this one, and write there how to put them back
    #[arg(long, value_name = "FOLDER")]
    pub(crate) move_to: Option<PathBuf>,
    /// Put back what --move-to has moved
    #[arg(long, value_name = "JOURNAL", conflicts_with_all = ["inputs", "reference", "csv", "html", "move_to"])]
    pub(crate) undo: Option<PathBuf>,
    /// What counts as a duplicate
    #[arg(
        long,
        value_name = "KIND,...",
        value_parser = kinds(),
        value_delimiter = ',',
        default_value = "file,geometry,scaled,mirrored,noisy,remeshed"
    )]
    pub(crate) kinds: Vec<RelationKind>,
    /// The least confidence, 0 to 1
    #[arg(long, value_name = "P", default_value_t = 0.9)]
    pub(crate) min_confidence: f64,
}

/// Kinds of relations by name.
fn kinds() -> impl TypedValueParser<Value = RelationKind> {
    one_of(vec![
        ("file", "The same bytes", RelationKind::IdenticalFile),
        ("geometry", "The same vertices and faces", RelationKind::IdenticalGeometry),
        ("scaled", "The same geometry at another size", RelationKind::Scaled),
        ("mirrored", "The mirror image", RelationKind::Mirrored),
        ("noisy", "The same faces with noise", RelationKind::Noisy),
        ("remeshed", "The same surface with other triangles", RelationKind::Remeshed),
        ("copies", "Several copies in one file", RelationKind::Copies),
        ("part", "A component or a piece", RelationKind::PartOf),
        ("variant", "The same part with another hole, thickness, length or detail", RelationKind::Variant),
        ("pose", "The same shape in another pose", RelationKind::OtherPose),
    ])
}
