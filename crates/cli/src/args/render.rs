//! Arguments of `canonform render`.

use std::path::PathBuf;

use canonform::mesh::InputPoint;
use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use report::color::ColorMap;
use report::render::{Background, View};

use super::settings::RepairArgs;
use super::shared::{LimitArgs, counted, read};

/// How views and fields are written.
const NOTES: &str = "\
Views: front, back, left, right, top, bottom, `principal` (along the principal axes of the surface), or
AZIMUTH,ELEVATION in degrees: how far the viewer walks counter-clockwise around the shape from its front, and
how far up. Many files have y up: pass `--up y`.

A field has one value per vertex of the mesh file, in its order, as written by `canonform geodesic -o`: .npy
(vertices, or rows x vertices) or .csv (one row per line, or one value per line). Vertices without a finite
value, such as those that distances do not reach, are gray. A .ply file may carry the field itself, as written by
`geodesic -o x.ply` and `compare --residual-mesh x.ply`; it is drawn unless an option says otherwise.

Examples:
  canonform render cat.off -o cat.png
  canonform render cat.off --distance-from 17 --isolines 20 -o distances.png
  canonform render cat.off --field rows.npy --row 2 --range 0,80 --colors magma -o third.png
  canonform render cat.off --form --background dark --size 1200x800 -o form.png
  canonform render cat.off dog.ply -o pictures/

Several meshes: a mesh that cannot be drawn is reported and does not stop the others; the exit code is then 2.";

#[derive(Debug, Args)]
#[command(after_long_help = NOTES, after_help = "See `--help-all` for how to write views and fields, and for examples.")]
pub(crate) struct RenderArgs {
    /// Meshes, datasets (folders, archives, lists), patterns such as 'scans/*.ply', or `-` for standard input
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    /// Output picture: .png, or `-` for standard output; with several meshes or a folder of them, the folder to write
    /// NAME.png into
    #[arg(short, long, value_name = "PICTURE")]
    pub(crate) output: PathBuf,
    /// Width and height in pixels, or one number for both
    #[arg(long, default_value = "800x800", value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub(crate) size: [u32; 2],
    /// Where the viewer stands: the name of a view, or AZIMUTH,ELEVATION in degrees [default: 30,12, or principal with --form]
    #[arg(long, value_name = "VIEW", value_parser = parse_view, allow_hyphen_values = true)]
    pub(crate) view: Option<View>,
    /// Axis of the mesh that points up
    #[arg(long, hide_short_help = true, value_parser = axis(), default_value = "z")]
    pub(crate) up: [f64; 3],
    /// Background: white, dark, transparent or a color #rrggbb
    #[arg(long, hide_short_help = true, default_value = "white", value_name = "BACKGROUND", value_parser = parse_background)]
    pub(crate) background: Background,
    /// Color of the mesh, #rrggbb [default: a light clay, or the values that a .ply file carries]
    #[arg(long, hide_short_help = true, value_name = "#rrggbb", value_parser = parse_color, conflicts_with_all = ["field", "distance_from"])]
    pub(crate) color: Option<[u8; 3]>,
    /// Colors of the values
    #[arg(long, value_enum, default_value_t, value_name = "MAP")]
    pub(crate) colors: ColorMap,
    /// Color by the values in this file, one per vertex: .npy or .csv
    #[arg(long, value_name = "FIELD")]
    pub(crate) field: Option<PathBuf>,
    /// Row of the field, counted from 0; required if it has several
    #[arg(long, hide_short_help = true, value_name = "ROW", value_parser = counted::<usize>, requires = "field")]
    pub(crate) row: Option<usize>,
    /// Color by the distance from the nearest of these points, by fast marching; write points as for `canonform
    /// geodesic`
    #[arg(long, value_delimiter = ',', value_name = "POINTS", conflicts_with = "field")]
    pub(crate) distance_from: Vec<InputPoint>,
    /// Number of lines of equal value, evenly spaced over the range
    #[arg(long, hide_short_help = true, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) isolines: u32,
    /// The values of the darkest and the lightest color [default: the smallest and the largest]
    #[arg(long, hide_short_help = true, value_name = "LOW,HIGH", value_parser = parse_range, allow_hyphen_values = true)]
    pub(crate) range: Option<[f64; 2]>,
    /// Omit the color bar; small pictures have none
    #[arg(long, hide_short_help = true)]
    pub(crate) no_bar: bool,
    /// Draw the canonical form (NMDS from 100 samples) instead of the mesh
    #[arg(long)]
    pub(crate) form: bool,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

/// The direction of an axis.
fn axis() -> impl TypedValueParser<Value = [f64; 3]> {
    PossibleValuesParser::new(["x", "y", "z"])
        .map(|name| ["x", "y", "z"].map(|axis| f64::from(u8::from(axis == name))))
}

/// Pixels along a side. Drawing a picture of 4,096 x 4,096 takes a gigabyte.
const SIDES: std::ops::RangeInclusive<u32> = 16..=4096;

fn parse_size(text: &str) -> Result<[u32; 2], String> {
    let side = |text: &str| text.parse().ok().filter(|side| SIDES.contains(side));
    let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, text));
    let size = side(width).zip(side(height)).map(<[u32; 2]>::from);
    let (least, most) = (SIDES.start(), SIDES.end());
    let what = format!("a picture size; write for example 800x600, each side from {least} to {most} pixels");
    read(text, size, &what)
}

fn pair(text: &str) -> Option<[f64; 2]> {
    let (a, b) = text.split_once(',')?;
    let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
    Some([number(a)?, number(b)?])
}

const VIEWS: &str =
    "a view; give front, back, left, right, top, bottom, principal or two angles in degrees such as 30,12";

fn parse_view(text: &str) -> Result<View, String> {
    let [azimuth, elevation] = match text {
        "principal" => return Ok(View::Principal),
        "front" => [0.0, 0.0],
        "right" => [90.0, 0.0],
        "back" => [180.0, 0.0],
        "left" => [270.0, 0.0],
        "top" => [0.0, 90.0],
        "bottom" => [0.0, -90.0],
        _ => read(text, pair(text), VIEWS)?,
    };
    Ok(View::Upright { azimuth, elevation, up: [0.0, 0.0, 1.0].into() })
}

fn parse_range(text: &str) -> Result<[f64; 2], String> {
    let range = pair(text).filter(|[low, high]| low < high);
    read(text, range, "a range; give the smallest and the largest value, such as 0,80")
}

fn parse_color(text: &str) -> Result<[u8; 3], String> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let is_hex = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let color = u32::from_str_radix(digits, 16).ok().filter(|_| is_hex);
    let channels = color.map(u32::to_be_bytes).map(|[_, channels @ ..]| channels);
    read(text, channels, "a color; write it as #rrggbb, such as #3b6ea5")
}

const BACKGROUNDS: &str = "a background; give white, dark, transparent or a color such as #f4f1ea";

fn parse_background(text: &str) -> Result<Background, String> {
    match text {
        "white" => Ok(Background::WHITE),
        "dark" => Ok(Background::Color([24, 26, 31])),
        "transparent" => Ok(Background::Transparent),
        _ => read(text, parse_color(text).ok().map(Background::Color), BACKGROUNDS),
    }
}
