//! Options of `canonform match`.

use std::path::PathBuf;

use canonform::mesh::io::or_list;
use canonform::settings::MapSettings;
use clap::Args;

use super::PairArgs;
use super::settings::FormArgs;
use super::shared::LimitArgs;

/// What is written, and what the numbers mean.
const MATCH_NOTES: &str = "\
Shapes that are alike under a mirror, as animals are, have two maps: the direct one takes the left side to the left side, the
mirrored one to the right side. Both are found. The direct one goes to -o, unless it distorts distances clearly more; the other
one goes to a file beside it: map.npy and map-mirrored.npy. Without -o, only the table is printed.

  .npy   one int64 for each vertex of A, in its order: the vertex of B, or -1 for a vertex that the repair dropped; with --points,
         four float64: the face of B, and the weights of its corners
  .csv   a line `vertex,match,confidence` for each vertex of A; with --points, also `face,w0,w1,w2`
  .ply   B in the colors that the map carries from A. Beside it A in its colors, as map-source.ply, and a picture of both, as
         map.png
  .png   a picture of A in colors, and of B in the colors that the map carries to it; gray where the map is not to be relied on

distortion  the mean change of distances under the map, as a share of the square root of the area; both meshes at unit area
agreement   how far the map keeps the orientation of the surface, from -1 to 1
confidence  that this map is right, and not the next best of its kind; of a vertex: how well distances around it are kept

Known pairs: --landmarks takes two columns, a vertex of A and one of B: 17,42. They choose the map, and
contradictory ones are refused; one ear is enough to tell left from right. --initial takes a map as -o writes it, and refines it; with
--score, tells its distortion and confidence instead.

Transfer: --transfer takes one row for each vertex or each face of A, .npy or .csv, and -o then holds the rows of B by the first map.
Numbers with fractions are interpolated inside faces; whole numbers (an integer array, or a .csv of them) and words are labels, which
go to the nearest. Texture coordinates are two columns with three rows for each face of A, one for each corner, so that seams stay
whole. To transfer from B to A, exchange the meshes.

Examples:
  canonform match cat0.off cat1.off -o map.npy
  canonform match cat0.off cat1.off -o b-in-a-colors.ply
  canonform match cat0.off cat1.off --landmarks pairs.csv --points -o map.csv
  canonform match cat0.off cat1.off --transfer parts-of-cat0.csv -o parts-of-cat1.csv
  canonform match cat0.off cat1.off --functional c.npy --json";

#[derive(Debug, Args)]
#[command(after_long_help = MATCH_NOTES, after_help = "See `--help-all` for what is written, and for examples.")]
pub(crate) struct MatchArgs {
    #[command(flatten)]
    pub(crate) pair: PairArgs,
    #[arg(short, long, value_name = "MAP", help = match_help())]
    pub(crate) output: Option<PathBuf>,
    /// Known pairs of vertices, .csv or .npy: two columns, a vertex of A and one of B
    #[arg(long, value_name = "PAIRS")]
    pub(crate) landmarks: Option<PathBuf>,
    /// A map to start from, as -o writes it: .npy or .csv
    #[arg(long, value_name = "MAP")]
    pub(crate) initial: Option<PathBuf>,
    /// Score the map of --initial as it is, beside the best one that is found, instead of refining it
    #[arg(long, requires = "initial")]
    pub(crate) score: bool,
    /// Carry values or labels of the vertices or faces of A, or texture coordinates of their corners, to B: .npy or .csv, and so is -o
    #[arg(long, value_name = "FILE", requires = "output")]
    pub(crate) transfer: Option<PathBuf>,
    /// Map vertices to points inside faces, in -o and --json
    #[arg(long, conflicts_with = "transfer")]
    pub(crate) points: bool,
    /// Write the functional map of the first map: .npy, with the eigenfunctions of both meshes in two files beside it
    #[arg(long, value_name = "C.npy")]
    pub(crate) functional: Option<PathBuf>,
    #[command(flatten)]
    pub(crate) maps: MapSettings,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

/// Extensions of the files that maps are written to.
pub(crate) const MAP_FORMATS: [&str; 4] = ["npy", "csv", "ply", "png"];

/// Extensions of the files of rows that a map carries.
pub(crate) const VALUE_FORMATS: [&str; 2] = ["npy", "csv"];

fn match_help() -> String {
    format!("Output file of the first map: {}; a second map is written beside it", or_list(MAP_FORMATS))
}
