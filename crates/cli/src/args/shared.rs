//! Options that several commands share.

use canonform::geodesics::{FastMarchingOptions, Method, ObtuseTreatment, Update};
use canonform::{FormOptions, Samples, StressChoice};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use mesh::{ComponentPolicy, Orient, RepairOptions, Weld};

/// Options of every command.
#[derive(Debug, Clone, Args)]
pub(crate) struct Common {
    /// Print one JSON object to standard output and nothing else
    #[arg(long, global = true)]
    pub(crate) json: bool,
    /// Number of worker threads, 0 for all cores; results do not depend on it
    #[arg(long, global = true, default_value_t = 0, value_name = "N")]
    pub(crate) threads: usize,
    /// Seed for everything random
    #[arg(long, global = true, default_value_t = 0, value_name = "S")]
    pub(crate) seed: u64,
    /// Hide progress bars
    #[arg(long, short, global = true)]
    pub(crate) quiet: bool,
}

/// How meshes are repaired before anything is measured.
#[derive(Debug, Clone, Args)]
pub(crate) struct RepairArgs {
    /// What to do with a mesh of several components
    #[arg(long, help_heading = "Repair", value_parser = components(), default_value = "largest", value_name = "POLICY")]
    pub(crate) components: ComponentPolicy,
    /// Which vertices at exactly the same position to merge
    #[arg(long, help_heading = "Repair", value_parser = weld(), default_value = "seams")]
    pub(crate) weld: Weld,
}

fn components() -> impl TypedValueParser<Value = ComponentPolicy> {
    one_of([
        ("largest", "Keep the component with the largest area", ComponentPolicy::Largest),
        ("bridge", "Join the components by the shortest links between them", ComponentPolicy::Bridge),
        ("error", "Refuse the mesh", ComponentPolicy::Error),
    ])
}

fn weld() -> impl TypedValueParser<Value = Weld> {
    one_of([
        ("none", "None", Weld::None),
        ("seams", "Those on boundaries, which closes cracks", Weld::Seams),
        ("all", "All", Weld::All),
    ])
}

impl RepairArgs {
    pub(crate) fn options(&self) -> RepairOptions {
        RepairOptions { components: self.components, weld: self.weld, orient: Orient::Keep }
    }
}

/// Options of fast marching.
#[derive(Debug, Clone, Copy, Args)]
pub(crate) struct MarchingArgs {
    /// Local solver
    #[arg(long, help_heading = "Fast marching", value_parser = update(), default_value = "point-source")]
    pub(crate) update: Update,
    /// What to do about angles wider than 90 degrees
    #[arg(long, help_heading = "Fast marching", value_parser = obtuse(), default_value = "flip")]
    pub(crate) obtuse: ObtuseTreatment,
}

fn update() -> impl TypedValueParser<Value = Update> {
    one_of([
        ("point-source", "The front in a triangle comes from one point (more accurate)", Update::PointSource),
        ("planar", "The front in a triangle is a straight line (Kimmel and Sethian)", Update::Planar),
    ])
}

fn obtuse() -> impl TypedValueParser<Value = ObtuseTreatment> {
    one_of([
        ("flip", "Flip interior edges until few are left", ObtuseTreatment::Flip),
        (
            "unfold",
            "Unfold the surface across the angle and split it (Kimmel and Sethian)",
            ObtuseTreatment::Unfold,
        ),
        ("ignore", "Treat them like any other", ObtuseTreatment::Ignore),
    ])
}

impl MarchingArgs {
    /// A method, with these options if it is fast marching.
    pub(crate) fn of(self, method: Method) -> Method {
        let Self { update, obtuse } = self;
        match method {
            Method::FastMarching(_) => Method::FastMarching(FastMarchingOptions { update, obtuse }),
            other => other,
        }
    }
}

/// The options of every embedding. Flatten it last: its help heading applies to all options that follow.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Embedding")]
pub(crate) struct FormArgs {
    /// Number of samples, or `auto` to take as many as needed [default: 100]
    #[arg(short = 'n', long, value_name = "SAMPLES|auto")]
    pub(crate) samples: Option<Samples>,
    /// Dimensions of the embedding
    #[arg(long, default_value_t = 3, value_name = "K")]
    pub(crate) dim: usize,
    /// How to measure distances
    #[arg(long, value_parser = distance_method(), default_value = Method::default().name(), value_name = "METHOD")]
    pub(crate) geodesic: Method,
    #[command(flatten)]
    pub(crate) marching: MarchingArgs,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

impl FormArgs {
    /// These options, with the default method and sampling.
    pub(crate) fn options(&self, common: &Common) -> FormOptions {
        FormOptions {
            repair: self.repair.options(),
            geodesic: self.marching.of(self.geodesic),
            samples: self.samples.unwrap_or_default(),
            dim: self.dim,
            seed: common.seed,
            ..FormOptions::default()
        }
    }
}

/// How to find the stress of an embedding.
pub(crate) const STRESS: [(&str, &str, StressChoice); 4] = [
    ("auto", "Exactly up to 5,000 vertices, estimated beyond", StressChoice::Auto),
    ("exact", "From the distances between all pairs of vertices", StressChoice::Exact),
    ("estimate", "From the distances of 100 vertices to all others", StressChoice::Estimate),
    ("skip", "Not at all", StressChoice::Skip),
];

/// Reads values by their names, each with a line of help.
pub(crate) fn one_of<T: Clone + Send + Sync + 'static, const N: usize>(
    values: [(&'static str, &'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let possible = values.each_ref().map(|(name, help, _)| PossibleValue::new(*name).help(*help));
    PossibleValuesParser::new(possible).try_map(move |chosen| {
        let found = values.iter().find(|(name, ..)| *name == chosen);
        found.map(|(.., value)| value.clone()).ok_or_else(|| format!("`{chosen}` is unknown"))
    })
}

/// Reads a distance method by its name.
pub(crate) fn distance_method() -> impl TypedValueParser<Value = Method> {
    one_of(Method::all().map(|m| (m.name(), m.summary(), m)))
}
