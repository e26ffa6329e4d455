//! What `canonform render` is asked for.

use std::path::PathBuf;

use canonform::InputPoint;
use clap::Args;
use view::render::{Background, View};

use super::RepairArgs;

/// How views and fields are written.
const NOTES: &str = "\
Views: front, back, left, right, top, bottom, `principal` (the longest axes of the surface in the picture),
or AZIMUTH,ELEVATION in degrees: how far the viewer walks counter-clockwise around the shape from its
front, and how far up. Many files have y up: pass `--up y`.

Fields have one number a vertex of the mesh's file, in its order, as `canonform geodesic -o` writes them: .npy
(vertices, or rows x vertices) or .csv (one row a line, or one number a line). What is no finite number, and
what the distances do not reach, is grey.

Examples:
  canonform render cat.off -o cat.png
  canonform render cat.off --distance-from 17 --isolines 20 -o distances.png
  canonform render cat.off --field rows.npy --row 2 --range 0,80 -o third.png
  canonform render cat.off --form --background dark --size 1200x800 -o form.png";

#[derive(Debug, Args)]
#[command(after_long_help = NOTES, after_help = "`--help` says how views and fields are written, with examples.")]
pub(crate) struct RenderArgs {
    /// Mesh file
    pub(crate) mesh: PathBuf,
    /// Where to write the picture: .png
    #[arg(short, long, value_name = "PICTURE.png")]
    pub(crate) output: PathBuf,
    /// Width and height of the picture in pixels, or both as one number
    #[arg(long, default_value = "800x800", value_name = "WIDTHxHEIGHT", value_parser = parse_size)]
    pub(crate) size: Size,
    /// Where the viewer stands [default: 30,12, and principal with --form]
    #[arg(long, value_name = "VIEW|AZIMUTH,ELEVATION", value_parser = parse_view, allow_hyphen_values = true)]
    pub(crate) view: Option<Place>,
    /// Axis of the mesh that points up
    #[arg(long, value_enum, default_value_t = Axis::Z)]
    pub(crate) up: Axis,
    /// What is behind the mesh: white, dark, transparent or a colour #rrggbb
    #[arg(long, default_value = "white", value_name = "BACKGROUND", value_parser = parse_background)]
    pub(crate) background: Background,
    /// Colour of the mesh, #rrggbb [default: a light clay]
    #[arg(long, value_name = "#rrggbb", value_parser = parse_color, conflicts_with_all = ["field", "distance_from"])]
    pub(crate) color: Option<[u8; 3]>,
    /// Colour by numbers in a file, one a vertex: .npy or .csv
    #[arg(long, value_name = "FIELD")]
    pub(crate) field: Option<PathBuf>,
    /// Which row of the field, counted from 0; needed where it has several
    #[arg(long, value_name = "ROW", requires = "field")]
    pub(crate) row: Option<usize>,
    /// Colour by the distance from the nearest of these points, by fast marching: vertices, or points as
    /// `canonform geodesic` takes them
    #[arg(long, value_delimiter = ',', value_name = "POINT[,POINT...]", conflicts_with = "field")]
    pub(crate) distance_from: Vec<InputPoint>,
    /// Lines of equal value, evenly spaced over the range
    #[arg(long, default_value_t = 0, value_name = "N", value_parser = clap::value_parser!(u32).range(0..=1000))]
    pub(crate) isolines: u32,
    /// The values of the darkest and the lightest colour [default: the least and the greatest]
    #[arg(long, value_name = "LOW,HIGH", value_parser = parse_range, allow_hyphen_values = true)]
    pub(crate) range: Option<Range>,
    /// No colour bar; small pictures have none anyway
    #[arg(long)]
    pub(crate) no_bar: bool,
    /// Draw the canonical form (NMDS from 100 samples) instead of the mesh
    #[arg(long)]
    pub(crate) form: bool,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

/// Columns and rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// Least and greatest value.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Range(pub(crate) [f64; 2]);

/// Where the viewer stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Place {
    /// Degrees around and up.
    Angles([f64; 2]),
    Principal,
}

impl Place {
    pub(crate) fn view(self, up: Axis) -> View {
        match self {
            Self::Principal => View::Principal,
            Self::Angles([azimuth, elevation]) => {
                View::Upright { azimuth, elevation, up: up.direction().into() }
            }
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

impl Axis {
    fn direction(self) -> [f64; 3] {
        match self {
            Self::X => [1.0, 0.0, 0.0],
            Self::Y => [0.0, 1.0, 0.0],
            Self::Z => [0.0, 0.0, 1.0],
        }
    }
}

/// Pixels along a side. A picture of 4,096 x 4,096 takes a gigabyte while it is drawn.
const SIDES: std::ops::RangeInclusive<u32> = 16..=4096;

fn parse_size(text: &str) -> Result<Size, String> {
    let side = |text: &str| text.parse().ok().filter(|side| SIDES.contains(side));
    let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, text));
    match (side(width), side(height)) {
        (Some(width), Some(height)) => Ok(Size { width, height }),
        _ => Err(format!(
            "`{text}` is no size; write for example 800x600, each side from {} to {} pixels",
            SIDES.start(),
            SIDES.end()
        )),
    }
}

fn pair(text: &str) -> Option<[f64; 2]> {
    let (a, b) = text.split_once(',')?;
    let number = |text: &str| text.trim().parse().ok().filter(|x: &f64| x.is_finite());
    Some([number(a)?, number(b)?])
}

fn parse_view(text: &str) -> Result<Place, String> {
    Ok(Place::Angles(match text {
        "principal" => return Ok(Place::Principal),
        "front" => [0.0, 0.0],
        "right" => [90.0, 0.0],
        "back" => [180.0, 0.0],
        "left" => [270.0, 0.0],
        "top" => [0.0, 90.0],
        "bottom" => [0.0, -90.0],
        _ => pair(text).ok_or_else(|| {
            format!(
                "`{text}` is no view; give front, back, left, right, top, bottom, principal or two angles in \
                 degrees such as 30,12"
            )
        })?,
    }))
}

fn parse_range(text: &str) -> Result<Range, String> {
    match pair(text) {
        Some([low, high]) if low < high => Ok(Range([low, high])),
        _ => Err(format!("`{text}` is no range; give the least and the greatest value, such as 0,80")),
    }
}

fn parse_color(text: &str) -> Result<[u8; 3], String> {
    let digits = text.strip_prefix('#').unwrap_or(text);
    let channel = |i: usize| digits.get(2 * i..2 * i + 2).and_then(|pair| u8::from_str_radix(pair, 16).ok());
    let is_hex = digits.len() == 6 && digits.bytes().all(|b| b.is_ascii_hexdigit());
    match (is_hex, channel(0), channel(1), channel(2)) {
        (true, Some(r), Some(g), Some(b)) => Ok([r, g, b]),
        _ => Err(format!("`{text}` is no colour; write it as #rrggbb, such as #3b6ea5")),
    }
}

fn parse_background(text: &str) -> Result<Background, String> {
    match text {
        "white" => Ok(Background::White),
        "dark" => Ok(Background::Color([24, 26, 31])),
        "transparent" => Ok(Background::Transparent),
        _ => parse_color(text).map(Background::Color).map_err(|_| {
            format!("`{text}` is no background; give white, dark, transparent or a colour such as #f4f1ea")
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_one_number_or_two() {
        assert_eq!(parse_size("640x480"), Ok(Size { width: 640, height: 480 }));
        assert_eq!(parse_size("300"), Ok(Size { width: 300, height: 300 }));
        for text in ["", "x", "15", "800x", "4097x10", "1e3", "10x20x30"] {
            assert!(parse_size(text).unwrap_err().contains("16 to 4096"), "{text}");
        }
    }

    #[test]
    fn views_are_names_or_angles() {
        assert_eq!(parse_view("-30,12.5"), Ok(Place::Angles([-30.0, 12.5])));
        assert_eq!(parse_view("left"), Ok(Place::Angles([270.0, 0.0])));
        assert_eq!(parse_view("principal"), Ok(Place::Principal));
        for text in ["", "up", "30", "30,", "nan,0", "1,2,3"] {
            assert!(parse_view(text).unwrap_err().contains("principal"), "{text}");
        }
    }

    #[test]
    fn colours_are_six_hexadecimal_digits() {
        assert_eq!(parse_color("#0a1bFF"), Ok([10, 27, 255]));
        assert_eq!(parse_color("0a1bff"), Ok([10, 27, 255]));
        for text in ["", "#fff", "red", "#12345g", "#+1+1+1", "ééé"] {
            assert!(parse_color(text).is_err() && parse_background(text).is_err(), "{text}");
        }
        assert_eq!(parse_background("white"), Ok(Background::White));
    }

    #[test]
    fn ranges_ascend() {
        assert_eq!(parse_range("-1,2.5"), Ok(Range([-1.0, 2.5])));
        for text in ["", "1", "2,1", "1,1", "0,inf"] {
            assert!(parse_range(text).is_err(), "{text}");
        }
    }
}
