//! The command line: a contract that other people's scripts rely on.

mod embedding;
mod geodesic;
mod index;
mod render;
mod serve;

use std::path::PathBuf;

use canonform::geodesics::{FastMarchingOptions, Method, ObtuseTreatment, Update};
use canonform::{Samples, StressChoice};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, Parser, Subcommand, ValueEnum};
use mesh::io::{Content, mesh_files, or_list, writable};
use mesh::{ComponentPolicy, Orient, RepairOptions, Weld};

pub(crate) use embedding::EmbeddingArgs;
pub(crate) use geodesic::GeodesicArgs;
pub(crate) use index::{
    AddArgs, BuildArgs, EvaluateArgs, ExportArgs, IndexArgs, IndexCommand, MergeArgs, OneIndexArgs,
    RemoveArgs, SearchArgs,
};
pub(crate) use render::{Place, RenderArgs};
pub(crate) use serve::ServeArgs;

/// Nonrigid 3D shapes: surface distances, canonical forms, comparison.
///
/// A cat that sits and a cat that leaps are one shape. A mesh is embedded so that straight lines
/// equal its surface distances (Nystrom multidimensional scaling); bending drops out.
#[derive(Debug, Parser)]
#[command(name = "canonform", version, max_term_width = 100, after_help = meshes_help())]
pub(crate) struct Arguments {
    #[command(flatten)]
    pub(crate) common: Common,
    #[command(subcommand)]
    pub(crate) command: Command,
}

fn meshes_help() -> String {
    format!("A mesh is {}.", mesh_files())
}

/// Options of every command.
#[derive(Debug, Clone, Args)]
pub(crate) struct Common {
    /// Print one JSON object on standard output and nothing else
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Worker threads; 0 takes all cores. The result does not depend on it
    #[arg(long, global = true, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// Seed of everything random
    #[arg(long, global = true, default_value_t = 0, value_name = "S")]
    pub(crate) seed: u64,
    /// No progress bars
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Say what is in a mesh, what is broken and what would be repaired
    Info(InfoArgs),
    /// Measure distances and find shortest paths along the surface
    Geodesic(GeodesicArgs),
    /// Turn a mesh, or every mesh in a folder, into its canonical form
    Embed(EmbedArgs),
    /// Embed a mesh by every method and set their stress, time and memory side by side
    Methods(MethodsArgs),
    /// Align the canonical forms of two meshes and say how far apart they are
    Compare(CompareArgs),
    /// Draw a shaded picture of a mesh, coloured by distances or other numbers
    Render(RenderArgs),
    /// Make, change, check and write out an index of shapes
    Index(IndexArgs),
    /// Find the shapes of an index that are most like a mesh, and its class
    Search(SearchArgs),
    /// Score how well an index, or a matrix of distances, separates classes
    Evaluate(EvaluateArgs),
    /// Show an index in a browser: drop a mesh, see what it is like
    Serve(ServeArgs),
    /// Print a script that completes this program's arguments in a shell
    Completions(CompletionsArgs),
}

#[derive(Debug, Args)]
pub(crate) struct InfoArgs {
    /// Mesh files or folders of them
    #[arg(required = true, value_name = "MESH")]
    pub(crate) meshes: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

#[derive(Debug, Args)]
pub(crate) struct EmbedArgs {
    /// Mesh file, or a folder of them
    pub(crate) mesh: PathBuf,
    #[arg(short, long, value_name = "FORM", help = form_help())]
    pub(crate) output: PathBuf,
    /// Format of the forms of a folder
    #[arg(long, value_enum, default_value_t = FormFormat::Ply)]
    pub(crate) format: FormFormat,
    #[command(flatten)]
    pub(crate) embedding: EmbeddingArgs,
    /// How the stress is found
    #[arg(long, value_enum, default_value_t = StressName::Auto)]
    pub(crate) stress: StressName,
    /// How the distances are measured that the stress holds the form against [default: as --geodesic]
    #[arg(long, value_parser = distance_method(), value_name = "METHOD")]
    pub(crate) stress_against: Option<Method>,
}

#[derive(Debug, Args)]
pub(crate) struct MethodsArgs {
    /// Mesh file
    pub(crate) mesh: PathBuf,
    /// Number of samples, or `auto` to take as many as each method needs [default: 100]
    #[arg(short = 'n', long, value_name = "SAMPLES|auto")]
    pub(crate) samples: Option<Samples>,
    /// Dimensions of the embeddings
    #[arg(long, default_value_t = 3, value_name = "K")]
    pub(crate) dim: usize,
    /// How distances are measured
    #[arg(long, value_parser = distance_method(), default_value = Method::default().name(), value_name = "METHOD")]
    pub(crate) geodesic: Method,
    #[command(flatten)]
    pub(crate) marching: MarchingArgs,
    /// How the stress is found
    #[arg(long, value_enum, default_value_t = SharedStressName::Auto)]
    pub(crate) stress: SharedStressName,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CompareArgs {
    /// First mesh
    pub(crate) a: PathBuf,
    /// Second mesh
    pub(crate) b: PathBuf,
    /// Distance between aligned forms
    #[arg(long, value_enum, default_value_t = DistanceName::NnRms)]
    pub(crate) distance: DistanceName,
    #[arg(long, value_name = "OUT", help = residual_help())]
    pub(crate) residual_mesh: Option<PathBuf>,
    /// Exit with 1 when the distance at equal size is larger than this
    #[arg(long, value_name = "D")]
    pub(crate) threshold: Option<f64>,
    #[command(flatten)]
    pub(crate) embedding: EmbeddingArgs,
}

#[derive(Debug, Args)]
pub(crate) struct CompletionsArgs {
    /// The shell
    #[arg(value_enum)]
    pub(crate) shell: clap_complete::Shell,
}

fn form_help() -> String {
    format!(
        "Where to write the form: {} (.npy: vertices x dim, float64); for a folder of meshes, the folder to write \
         NAME.EXT into",
        or_list(FormFormat::extensions())
    )
}

fn residual_help() -> String {
    format!(
        "Write the first mesh coloured by how far each vertex is from the second shape, once aligned ({})",
        or_list(writable(Content::Field))
    )
}

/// How meshes are repaired before anything is measured.
#[derive(Debug, Clone, Args)]
pub(crate) struct RepairArgs {
    /// What happens to a mesh in several pieces
    #[arg(long, value_enum, default_value_t = ComponentsName::Largest, value_name = "POLICY")]
    pub(crate) components: ComponentsName,
    /// Which vertices in exactly the same place become one
    #[arg(long, value_enum, default_value_t = WeldName::Seams)]
    pub(crate) weld: WeldName,
}

impl RepairArgs {
    pub(crate) fn options(&self) -> RepairOptions {
        RepairOptions {
            components: match self.components {
                ComponentsName::Largest => ComponentPolicy::Largest,
                ComponentsName::Bridge => ComponentPolicy::Bridge,
                ComponentsName::Error => ComponentPolicy::Error,
            },
            weld: match self.weld {
                WeldName::None => Weld::None,
                WeldName::Seams => Weld::Seams,
                WeldName::All => Weld::All,
            },
            orient: Orient::Keep,
        }
    }
}

/// How fast marching marches.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct MarchingArgs {
    /// Local solver of fast marching
    #[arg(long, value_enum, default_value_t = UpdateName::PointSource)]
    pub(crate) update: UpdateName,
    /// What fast marching does at corners wider than 90 degrees
    #[arg(long, value_enum, default_value_t = ObtuseName::Flip)]
    pub(crate) obtuse: ObtuseName,
}

impl MarchingArgs {
    /// A method with these options, if it is fast marching.
    pub(crate) fn of(self, method: Method) -> Method {
        let update = match self.update {
            UpdateName::PointSource => Update::PointSource,
            UpdateName::Planar => Update::Planar,
        };
        let obtuse = match self.obtuse {
            ObtuseName::Flip => ObtuseTreatment::Flip,
            ObtuseName::Unfold => ObtuseTreatment::Unfold,
            ObtuseName::Ignore => ObtuseTreatment::Ignore,
        };
        match method {
            Method::FastMarching(_) => Method::FastMarching(FastMarchingOptions { update, obtuse }),
            other => other,
        }
    }
}

/// Reads values by the names that the library gives them, each with a line of help.
fn one_of<T: Clone + Send + Sync + 'static, const N: usize>(
    values: [(&'static str, &'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let possible = values.each_ref().map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(possible).try_map(move |chosen| {
        let found = values.iter().find(|(name, ..)| *name == chosen);
        found.map(|(.., value)| value.clone()).ok_or_else(|| format!("`{chosen}` is unknown"))
    })
}

/// Reads a distance method by its name.
fn distance_method() -> impl TypedValueParser<Value = Method> {
    one_of(Method::all().map(|m| (m.name(), m.summary(), m)))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum UpdateName {
    /// The front in a triangle comes from one point (more accurate)
    PointSource,
    /// The front in a triangle is a straight line (Kimmel and Sethian)
    Planar,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ObtuseName {
    /// Flip edges inside the surface until few are left
    Flip,
    /// Unfold the surface behind the corner and split it (Kimmel and Sethian)
    Unfold,
    /// Treat it like any other
    Ignore,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum StressName {
    /// Exact up to 5,000 vertices, estimated beyond
    Auto,
    /// From all pairs of vertices
    Exact,
    /// From 100 vertices to all others
    Estimate,
    /// Not at all
    Skip,
}

impl From<StressName> for StressChoice {
    fn from(name: StressName) -> Self {
        match name {
            StressName::Auto => Self::Auto,
            StressName::Exact => Self::Exact,
            StressName::Estimate => Self::Estimate,
            StressName::Skip => Self::Skip,
        }
    }
}

/// How the stress of all methods is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SharedStressName {
    /// Exact up to 5,000 vertices, estimated beyond
    Auto,
    /// From all pairs of vertices
    Exact,
    /// From 100 vertices to all others, the same for all methods
    Estimate,
}

impl From<SharedStressName> for StressChoice {
    fn from(name: SharedStressName) -> Self {
        match name {
            SharedStressName::Auto => Self::Auto,
            SharedStressName::Exact => Self::Exact,
            SharedStressName::Estimate => Self::Estimate,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum ComponentsName {
    /// Keep the piece of the largest area
    Largest,
    /// Join the pieces by the shortest links between them
    Bridge,
    /// Refuse the mesh
    Error,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum WeldName {
    /// None
    None,
    /// Those on boundaries, so that cracks close
    Seams,
    /// All
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum FormFormat {
    /// Binary PLY mesh
    Ply,
    /// Wavefront mesh
    Obj,
    /// OFF mesh
    Off,
    /// NumPy array
    Npy,
}

impl FormFormat {
    pub(crate) fn extensions() -> impl Iterator<Item = &'static str> {
        Self::value_variants().iter().map(|format| format.extension())
    }

    pub(crate) fn extension(self) -> &'static str {
        match self {
            Self::Ply => "ply",
            Self::Obj => "obj",
            Self::Off => "off",
            Self::Npy => "npy",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum DistanceName {
    /// Root mean square of nearest-neighbour distances
    NnRms,
    /// Hausdorff distance of the closest 95 %
    Hausdorff95,
}
