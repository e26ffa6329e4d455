//! The command line: a contract that other people's scripts rely on.

mod duplicates;
mod field;
mod generate;
mod geodesic;
mod index;
mod matching;
mod render;
mod serve;
mod settings;
mod shared;

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use canonform::collection::Storage;
use canonform::embed::StressChoice;
use canonform::mesh::InputPoint;
use canonform::mesh::io::{Content, files_in, mesh_files, or_list, writable};
use canonform::relations::RelationKind;
use canonform::settings::{Geodesic, MethodSettings, StressSettings};
use clap::builder::TypedValueParser;
use clap::{Arg, ArgAction, ArgMatches, Args, CommandFactory, FromArgMatches, Id, Parser, Subcommand};
use clap_complete::Shell;

use self::settings::{FormArgs, one_of};

pub(crate) use duplicates::DuplicatesArgs;
pub(crate) use field::{FieldBuildArgs, FieldCommand, FieldQueryArgs};
pub(crate) use generate::{FamilyArg, GenerateArgs};
pub(crate) use geodesic::GeodesicArgs;
pub(crate) use index::{AddArgs, BuildArgs, EvaluateArgs, IndexCommand, ListArgs, SearchArgs};
pub(crate) use matching::{MAP_FORMATS, MatchArgs, VALUE_FORMATS};
pub(crate) use render::RenderArgs;
pub(crate) use serve::ServeArgs;
pub(crate) use settings::{MAX_DROPPED, RepairArgs, geodesic_method, spelled};
pub(crate) use shared::{Common, LimitArgs};

/// Nonrigid 3D shapes: surface distances, canonical forms, comparison and search.
///
/// A sitting cat and a leaping cat are the same shape. canonform embeds a mesh so that straight-line distances equal its
/// surface distances (Nystrom multidimensional scaling), which removes the effect of bending.
#[derive(Debug, Parser)]
#[command(name = "canonform", version, max_term_width = 100, after_help = inputs_help())]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The program with its commands. `-h` and `--help` list what is often needed, `--help-all` everything.
pub(crate) fn program() -> clap::Command {
    with_help(Arguments::command())
}

fn with_help(command: clap::Command) -> clap::Command {
    let usual = Arg::new("help").short('h').long("help").action(ArgAction::HelpShort);
    let all = Arg::new("help_all").long("help-all").action(ArgAction::HelpLong);
    let names: Vec<String> = command.get_subcommands().map(|inner| inner.get_name().to_owned()).collect();
    // The parser of a value says what is wrong with `--source -1`; clap would take it for an unknown flag.
    let takes_minus = |arg: Arg| match (arg.is_positional(), arg.get_value_delimiter()) {
        (true, _) => arg,
        _ if !arg.get_action().takes_values() => arg,
        (false, None) => arg.allow_negative_numbers(true),
        (false, Some(_)) => arg.allow_hyphen_values(true),
    };
    let command = command
        .mut_args(takes_minus)
        .disable_help_flag(true)
        .next_help_heading(None::<&str>)
        .arg(usual.help("Print this help").display_order(990))
        .arg(all.help("Print help with all options, their values, and notes").display_order(991));
    names.into_iter().fold(command, |command, name| command.mut_subcommand(name, with_help))
}

/// Options and arguments that name what a command writes, or changes.
const WRITTEN: [&str; 9] =
    ["output", "csv", "html", "residual_mesh", "functional", "index", "inputs", "move_to", "undo"];

/// Parses the command line, or prints help or an error and ends the program. All other files that it names are inputs, which
/// no result may replace.
pub(crate) fn parsed() -> Arguments {
    let (matches, arguments) = read(std::env::args_os()).unwrap_or_else(|fault| {
        // The fault quotes what was given, which may end its line or hold codes of terminals.
        let printable =
            std::env::args_os().map(|word| base::one_line(&word.to_string_lossy()).into_owned().into());
        read(printable).err().unwrap_or(fault).exit()
    });
    let mut command = Some(&matches);
    while let Some(inner) = command {
        let given = inner.ids().map(Id::as_str).filter(|id| !WRITTEN.contains(id));
        let values = given.filter_map(|id| inner.try_get_raw(id).ok().flatten()).flatten();
        values.map(Path::new).filter(|path| path.is_file()).for_each(keep_inputs);
        command = inner.subcommand().map(|(_, inner)| inner);
    }
    arguments
}

fn read(words: impl Iterator<Item = OsString>) -> Result<(ArgMatches, Arguments), clap::Error> {
    let matches = program().try_get_matches_from(words)?;
    let arguments = Arguments::from_arg_matches(&matches).map_err(|fault| fault.format(&mut program()))?;
    Ok((matches, arguments))
}

/// Keeps the files of a mesh, or of whatever an argument names, from being replaced by a result.
pub(crate) fn keep_inputs(path: &Path) {
    files_in(path, &Storage).iter().for_each(|file| base::files::keep_input(file));
}

/// What commands read.
fn inputs_help() -> String {
    format!(
        "A mesh is {}; compressed, as cat.obj.gz; a member of an archive, as cats.zip/cat0.off; or an archive of one mesh.\n\
         A dataset is a folder, a .zip, .tar or .tar.gz archive, a .parquet file with the columns id, label, format and bytes, \
         or a .txt file with a path in every line.",
        mesh_files()
    )
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Report what a mesh contains, its defects, and what a repair would change
    Info(InfoArgs),
    /// Measure distances and shortest paths along a surface
    Geodesic(GeodesicArgs),
    /// Store the distances between all pairs of vertices in little memory, with bounds
    #[command(subcommand)]
    Field(FieldCommand),
    /// Compute the canonical form of a mesh, or of every mesh of a folder or an archive
    Embed(EmbedArgs),
    /// Embed a mesh by every method and tabulate stress, time and memory
    Methods(MethodsArgs),
    /// Say how two meshes are related: one file, geometry, surface, shape or class, scaled, mirrored, or a part
    ///
    /// The relation is told from the files and from the meshes in space: the same bytes; the same vertices, perhaps moved, scaled
    /// or mirrored; the same surface, decimated, subdivided, remeshed or with noise; copies or a part of each other. If
    /// they are none of these, the shapes decide: another pose, one class, or different.
    ///
    /// Shapes are compared by their combined distance, by signatures and aligned canonical forms. The certainty is a probability,
    /// measured on poses and bodies of the built-in shapes.
    Compare(CompareArgs),
    /// Map the vertices of a mesh to those of another one
    Match(MatchArgs),
    /// Convert a mesh, or every mesh of a folder or an archive, to another file format
    Convert(ConvertArgs),
    /// Draw a shaded picture of a mesh, optionally colored by distances or other values
    Render(RenderArgs),
    /// Build, change, check and export an index of shapes
    #[command(subcommand)]
    Index(IndexCommand),
    /// Find the shapes of an index that are most similar to meshes, and predict their classes
    Search(SearchArgs),
    /// Find files that hold one shape, in an index or a folder, and suggest which to keep
    Duplicates(DuplicatesArgs),
    /// Score how well an index or a matrix of distances separates classes
    Evaluate(EvaluateArgs),
    /// Serve an index to browsers: drop a mesh and see the most similar shapes
    Serve(ServeArgs),
    /// Write built-in shapes as mesh files: cats, centaurs, men, random creatures or mechanical parts
    Generate(GenerateArgs),
    /// Print a completion script for a shell
    Completions {
        /// The shell
        #[arg(value_enum)]
        shell: Shell,
    },
}

#[derive(Debug, Args)]
#[command(after_help = "Exit code 2 if a mesh cannot be read; the others are reported all the same.")]
pub(crate) struct InfoArgs {
    /// Meshes, datasets (folders, archives, lists), patterns such as 'scans/*.ply', or `-` for standard input
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

/// What stress is, and what happens to several meshes.
const EMBED_NOTES: &str = "\
Stress, with the distances d_ij between p vertices along the surface and the coordinates z_i:
  stress             ||Z Z' + 1/2 J E J||_F / p, with E_ij = d_ij^2 and J = I - 1/p: the paper's, in squared mesh units
  normalized stress  sqrt(sum (d_ij - |z_i - z_j|)^2 / sum d_ij^2): the relative error of the distances, without a unit

Number of samples: with -n auto, until twice as many reduced the stress by less than 1 %. The choice is made on distances
from points that are no samples; the stress and its interval are then estimated from others, so the choice does not bias
them.

Several meshes: each form is written to FOLDER/NAME.EXT. A mesh that cannot be embedded is reported and does not
stop the others; the exit code is then 2.

Examples:
  canonform embed cat.off -o form.ply
  canonform embed cat.off -n auto -o form.ply
  canonform embed cat.off dog.ply 'scans/*.obj' -o forms/ --output-format npy
  canonform embed cats.zip -o forms/
  canonform embed fine.off --extend coarse.off -o fine.ply
  canonform embed - --format off -o - --output-format ply < cat.off > form.ply";

#[derive(Debug, Args)]
#[command(after_long_help = EMBED_NOTES, after_help = "See `--help-all` for the options of methods, the formulas of the stress, and examples.")]
pub(crate) struct EmbedArgs {
    /// Meshes, datasets (folders, archives, lists), patterns such as 'scans/*.ply', or `-` for standard input
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    #[arg(short, long, value_name = "FORM", help = form_help())]
    pub(crate) output: PathBuf,
    #[arg(
        long,
        value_name = "EXT",
        value_parser = one_of(FORM_FORMATS.map(|(name, help)| (name, help, name)).into()),
        help = "File format of forms in a folder or on standard output [default: ply]"
    )]
    pub(crate) output_format: Option<&'static str>,
    /// Report the coordinates of these points too: 17 is a vertex, 17-42@0.3 a point on an edge, f8@2:1:1 one in a face, as in
    /// `canonform geodesic`
    #[arg(long, value_delimiter = ',', value_name = "POINT[,POINT...]")]
    pub(crate) at: Vec<InputPoint>,
    /// Place the mesh in the form of a coarser mesh of the same surface, by the distances from the samples of that form
    #[arg(long, value_name = "COARSER", conflicts_with = "stress_against")]
    pub(crate) extend: Option<PathBuf>,
    /// Write the mesh itself, bent into the canonical form as rigidly as possible: limbs stay round, and ears stay ears. The
    /// stress is that of the form
    #[arg(long, conflicts_with_all = ["extend", "at"])]
    pub(crate) features: bool,
    /// How to measure the distances that the stress compares the form with [default: as --geodesic]
    #[arg(long, value_name = "METHOD")]
    pub(crate) stress_against: Option<Geodesic>,
    #[command(flatten)]
    pub(crate) stress: StressSettings,
    #[command(flatten)]
    pub(crate) method: MethodSettings,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

/// What is kept and what is not.
const CONVERT_NOTES: &str = "\
Vertices keep their order, and coordinates their numbers: OFF, OBJ, PLY and 3MF files read back bit for bit, STL and GLB files
round to 32 bits. Units are not converted. Colors, textures and materials are left out.

Examples:
  canonform convert cat.glb cat.ply
  canonform convert scans.zip scans/ --output-format off
  canonform convert --repair scan.obj scan.3mf
  canonform convert - - --format obj --output-format glb < cat.obj > cat.glb";

#[derive(Debug, Args)]
#[command(after_long_help = CONVERT_NOTES, after_help = "See `--help-all` for what is kept, and for examples.")]
pub(crate) struct ConvertArgs {
    /// Mesh, dataset or pattern, or `-` for standard input
    #[arg(value_name = "IN")]
    pub(crate) input: PathBuf,
    #[arg(value_name = "OUT", help = convert_help())]
    pub(crate) output: PathBuf,
    /// File format of meshes in a folder or on standard output
    #[arg(long, value_name = "EXT")]
    pub(crate) output_format: Option<String>,
    /// Repair the mesh, as other commands do before they measure: the options below say how. Dropped vertices are left out
    #[arg(long)]
    pub(crate) repair: bool,
    #[command(flatten)]
    pub(crate) repair_options: RepairArgs,
}

fn convert_help() -> String {
    format!(
        "Output file: {}, also compressed as .ply.gz, or `-` for standard output; with several meshes, the folder to write \
         NAME.EXT into",
        or_list(writable(Content::Mesh))
    )
}

#[derive(Debug, Args)]
pub(crate) struct MethodsArgs {
    /// Mesh file, or `-` for standard input
    pub(crate) mesh: PathBuf,
    /// How to find the stress
    #[arg(long, value_parser = compared_stress(), default_value = "auto")]
    pub(crate) stress: StressChoice,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

/// How the stress is found when methods are compared.
fn compared_stress() -> impl TypedValueParser<Value = StressChoice> {
    use StressChoice::{Auto, Estimate, Exact};
    one_of(vec![
        ("auto", "Exactly up to 5,000 vertices, beyond from 100 vertices to all others", Auto),
        ("exact", "From the distances between all pairs of vertices", Exact),
        ("estimate", "From the distances of 100 vertices to all others", Estimate),
    ])
}

/// Two meshes.
#[derive(Debug, Args)]
pub(crate) struct PairArgs {
    /// First mesh, a file or `-` for standard input
    pub(crate) a: PathBuf,
    /// Second mesh, a file or `-`
    pub(crate) b: PathBuf,
}

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    #[command(flatten)]
    pub(crate) pair: PairArgs,
    #[arg(long, value_name = "OUT", help = residual_help())]
    pub(crate) residual_mesh: Option<PathBuf>,
    /// Exit with code 1 if the distance at equal size exceeds this, or if the shapes are certainly of different classes
    #[arg(long, value_name = "D")]
    pub(crate) threshold: Option<f64>,
    /// Exit with code 0 if the shapes are at least this alike, probably or certainly, and 1 if not: `same-shape` without a value
    #[arg(long, value_name = "KIND", num_args = 0..=1, require_equals = true, default_missing_value = "same-shape",
        value_parser = at_least())]
    pub(crate) exit_code: Option<&'static [RelationKind]>,
    #[command(flatten)]
    pub(crate) method: MethodSettings,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    #[command(flatten)]
    pub(crate) limits: LimitArgs,
}

/// Extensions of the files that forms are written to, each with a line of help.
pub(crate) const FORM_FORMATS: [(&str, &str); 4] =
    [("npy", "NumPy array"), ("ply", "Binary PLY mesh"), ("obj", "Wavefront mesh"), ("off", "OFF mesh")];

/// Kinds besides those of one surface.
fn at_least() -> impl TypedValueParser<Value = &'static [RelationKind]> {
    use RelationKind::{OtherPose, SameClass, Variant};
    one_of::<&[RelationKind]>(vec![
        ("same-shape", "One body in two poses, at any size, or its mirror image", &[OtherPose]),
        ("same-class", "One class, whether one shape or not", &[Variant, OtherPose, SameClass]),
    ])
}

fn form_help() -> String {
    format!(
        "Output file: {} (.npy: vertices x dim, float64), or `-` for standard output; with several meshes or a folder of \
         them, the folder to write NAME.EXT into",
        or_list(FORM_FORMATS.map(|(extension, _)| extension))
    )
}

fn residual_help() -> String {
    format!(
        "Write the first mesh, colored by the distance of each vertex from the second shape after alignment ({}; only \
         .ply also holds the values, and `canonform render` draws them)",
        or_list(writable(Content::Field))
    )
}
