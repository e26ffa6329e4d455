//! Arguments of `canonform geodesic`.

use std::path::PathBuf;

use canonform::InputPoint;
use canonform::geodesics::Method;
use clap::Args;
use mesh::io::{Content, or_list, writable};

use super::shared::{MarchingArgs, RepairArgs, distance_method};

/// How points are written.
const POINTS: &str = "\
Points use the vertex and face numbers of the input file, counted from 0:
  17          vertex 17
  17-42@0.3   the point at 0.3 of the way from vertex 17 to vertex 42, along their edge
  f8@2:1:1    the point of face 8 with these weights at its corners, in the order of the file
Without `@`, the midpoint of the edge or the centroid of the face.

Distances are infinite (inf) at vertices that the repair dropped and beyond --max-distance.

Examples:
  canonform geodesic cat.off --source 0,17 -o rows.npy
  canonform geodesic cat.off --source 0,f8 --nearest --max-distance 5 -o near.ply
  canonform geodesic cat.off --source 0 --path-to 17,42 --method exact -o paths.obj
  canonform geodesic cat.off --all-pairs --memory 2G -o pairs.npy";

#[derive(Debug, Args)]
#[command(after_long_help = POINTS, after_help = "See `--help` for how to write points, and for examples.")]
pub(crate) struct GeodesicArgs {
    /// Mesh file
    pub(crate) mesh: PathBuf,
    /// Sources: vertices, or points on edges and faces; each gives one row of distances
    #[arg(
        long,
        required_unless_present = "all_pairs",
        value_delimiter = ',',
        value_name = "POINT[,POINT...]"
    )]
    pub(crate) source: Vec<InputPoint>,
    #[arg(short, long, value_name = "OUT", help = output_help())]
    pub(crate) output: PathBuf,
    /// Measure the distance to the nearest source: a single row
    #[arg(long)]
    pub(crate) nearest: bool,
    /// Measure no farther than this, in mesh units; distances beyond are inf
    #[arg(long, value_name = "D", value_parser = parse_distance)]
    pub(crate) max_distance: Option<f64>,
    /// Write shortest paths to these points instead of distances: from every source, or with --nearest from the nearest
    /// one. Only --method exact guarantees that they are shortest
    #[arg(long, value_delimiter = ',', value_name = "POINT[,POINT...]")]
    pub(crate) path_to: Vec<InputPoint>,
    /// Write the distances between all pairs of vertices (vertices x vertices, symmetric: the average of both
    /// directions), a block of rows at a time
    #[arg(long, conflicts_with_all = ["source", "nearest", "max_distance", "path_to"])]
    pub(crate) all_pairs: bool,
    /// Memory for the distances that --all-pairs holds at once, in bytes or with K, M, G or T [default: 1G]
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes, conflicts_with = "source")]
    pub(crate) memory: Option<usize>,
    /// How to measure distances
    #[arg(long, value_parser = distance_method(), default_value = Method::default().name())]
    pub(crate) method: Method,
    #[command(flatten)]
    pub(crate) marching: MarchingArgs,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

fn output_help() -> String {
    format!(
        "Output file. Distances: .npy (sources x vertices, float64), .csv (one row per source) or {} (one \
         coloured mesh per source). Paths: {} (lines), .csv or .json. All pairs: .npy",
        or_list(writable(Content::Field)),
        or_list(writable(Content::Lines))
    )
}

fn parse_distance(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(distance) if distance >= 0.0 => Ok(distance),
        _ => Err(format!("`{text}` is not a distance; give a non-negative number of mesh units")),
    }
}

/// A number of bytes; K, M, G and T are powers of 1024.
fn parse_bytes(text: &str) -> Result<usize, String> {
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
