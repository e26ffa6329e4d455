//! Arguments of `canonform geodesic`.

use std::path::PathBuf;

use canonform::mesh::InputPoint;
use canonform::mesh::io::{Content, or_list, writable};
use canonform::settings::{Geodesic, MarchingSettings};
use clap::Args;

use super::settings::RepairArgs;
use super::shared::{LimitArgs, read};

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
  canonform geodesic cat.off --source 0 --path-to 17,42 -o paths.obj
  canonform geodesic cat.off --all-pairs --memory 2G -o pairs.npy
  canonform geodesic - --format off --source 0 -o - --output-format csv < cat.off";

#[derive(Debug, Args)]
#[command(after_long_help = POINTS, after_help = "See `--help-all` for how to write points, and for examples.")]
pub(crate) struct GeodesicArgs {
    /// Mesh file, or `-` for standard input
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
    /// File format on standard output
    #[arg(long, default_value = "npy", value_name = "EXT")]
    pub(crate) output_format: String,
    /// Measure the distance to the nearest source: a single row
    #[arg(long)]
    pub(crate) nearest: bool,
    /// Measure no farther than this, in mesh units; distances beyond are inf
    #[arg(long, value_name = "D", value_parser = parse_distance)]
    pub(crate) max_distance: Option<f64>,
    /// Write shortest paths to these points instead of distances: from every source, or with --nearest from the nearest
    /// one. They are shortest whatever the method
    #[arg(long, value_delimiter = ',', value_name = "POINT[,POINT...]")]
    pub(crate) path_to: Vec<InputPoint>,
    /// Write the distances between all pairs of vertices (vertices x vertices, symmetric: the average of both
    /// directions), in blocks of as many rows as fit into --memory [default: 1G]
    #[arg(long, conflicts_with_all = ["source", "nearest", "max_distance", "path_to"])]
    pub(crate) all_pairs: bool,
    /// Write a matrix of all pairs that is larger than 100 GB
    #[arg(long, requires = "all_pairs")]
    pub(crate) force: bool,
    /// How to measure distances
    #[arg(long, default_value = "fast-marching")]
    pub(crate) method: Geodesic,
    #[command(flatten)]
    pub(crate) marching: MarchingSettings,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

fn output_help() -> String {
    format!(
        "Output file. Distances: .npy (sources x vertices, float64), .csv (one row per source) or {} (one \
         colored mesh per source). Paths: {} (lines), .csv or .json. All pairs: .npy. `-` for standard output",
        or_list(writable(Content::Field)),
        or_list(writable(Content::Lines))
    )
}

fn parse_distance(text: &str) -> Result<f64, String> {
    let distance = text.parse().ok().filter(|distance| *distance >= 0.0);
    read(text, distance, "a distance; give a non-negative number of mesh units")
}
