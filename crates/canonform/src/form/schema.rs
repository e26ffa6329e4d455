//! The schema of options: every option that decides a form, a description or a comparison, declared once.
//!
//! Programs make their flags and keywords of [`SCHEMA`], and [`Settings`](super::settings::Settings) reads their values.

use std::fmt::Display;
use std::str::FromStr;

use geodesics::{Method, ObtuseTreatment, Sampling, Update};
use mesh::{ComponentPolicy, Weld};
use nmds::{Bandwidth, Regularization, RpiAlpha};

use super::distances::Samples;
use super::method::EmbedMethod;
use super::stress::StressChoice;

/// What an option is about; a program offers those groups that its command uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OptionGroup {
    /// Which method makes coordinates of distances, and the options of methods.
    Method,
    /// What every method needs.
    Form,
    /// Options of fast marching.
    Marching,
    /// How meshes are repaired.
    Repair,
    /// How the stress is found.
    Stress,
    /// What is kept of a form.
    Description,
    /// How surfaces are mapped.
    Maps,
}

/// One option: its name, its meaning, and what values it may have.
#[derive(Debug)]
pub struct OptionSpec {
    /// Its name; words are joined by underscores.
    pub name: &'static str,
    /// What Python calls it: there, samples are landmarks, as in scikit-learn, and counts begin with `n_`.
    pub keyword: &'static str,
    /// What it is about.
    pub group: OptionGroup,
    /// What its values look like, such as `C|paper`; empty for options with [named values](Self::names).
    pub placeholder: &'static str,
    /// Its default in words; empty for an option that is off by default.
    pub default: &'static str,
    /// Whether few users need it, so that help pages may leave it out.
    pub is_advanced: bool,
    help: &'static str,
    names: fn() -> Vec<(&'static str, &'static str)>,
    check: fn(&str) -> Result<(), String>,
    applies: fn(&EmbedMethod) -> bool,
}

/// Values that are chosen by name.
pub trait Named: Sized {
    /// All values, each with its name and a line of help.
    fn table() -> Vec<(&'static str, &'static str, Self)>;

    /// The value of this name.
    fn named(name: &str) -> Option<Self> {
        Self::table().into_iter().find(|(known, ..)| *known == name).map(|(.., value)| value)
    }
}

/// Every option. Commands list them in this order.
pub static SCHEMA: [OptionSpec; 22] = [
    named::<EmbedMethod>(OptionGroup::Method, "method", "nmds", "How to turn distances into coordinates"),
    parsed::<Samples>(OptionGroup::Form, "samples", "SAMPLES|auto", "100", "Number of samples, or `auto` to take as many as needed")
        .called("n_landmarks"),
    parsed::<usize>(OptionGroup::Form, "dim", "K", "3", "Dimensions of the embedding").called("n_components"),
    named::<Method>(OptionGroup::Form, "geodesic", "fast-marching", "How to measure distances"),
    named::<Update>(OptionGroup::Marching, "update", "virtual-source", "Local solver").advanced(),
    named::<ObtuseTreatment>(
        OptionGroup::Marching,
        "obtuse",
        "flip",
        "What to do about angles wider than 90 degrees",
    ).advanced(),
    named::<ComponentPolicy>(
        OptionGroup::Repair,
        "components",
        "largest",
        "What to do with a mesh of several components",
    ),
    parsed::<Weld>(
        OptionGroup::Repair,
        "weld",
        "seams|all|none|TOL",
        "seams",
        "Which vertices to merge: `seams` on boundaries (the default), `all`, `none`, or a distance\n\n\
         `seams` merges boundary vertices in the same position, and boundary edges that nearly coincide: those whose ends \
         are within 2 % of the shortest side of their faces. A number merges boundary vertices within this distance, in mesh \
         units. `all` merges all vertices in the same position. Two vertices of one edge are never merged.",
    ),
    parsed::<usize>(
        OptionGroup::Method,
        "rank",
        "N1",
        "half the samples, at least {dim} + 4",
        "Number of eigenpairs of the sample matrix to keep (of columns for cur)",
    )
    .of(|m| m.regularization().is_some() || matches!(m, EmbedMethod::KernelPca { .. })).advanced(),
    named::<Sampling>(OptionGroup::Method, "sampling", "farthest", "How to choose samples")
        .of(EmbedMethod::is_sampled).advanced(),
    parsed::<u32>(
        OptionGroup::Method,
        "first_sample",
        "V",
        "the vertex farthest from vertex 0; with other samplings, drawn with {seed}",
        "First sample, a vertex of the input",
    )
    .called("first")
    .of(EmbedMethod::is_sampled).advanced(),
    named::<Regularization>(
        OptionGroup::Method,
        "regularization",
        "low-rank",
        "How nmds, and the start of smacof, regularise the inverse of the sample matrix",
    )
    .of(is_regularized).advanced(),
    parsed::<RpiAlpha>(
        OptionGroup::Method,
        "alpha",
        "C|paper",
        "1e-10",
        "For {regularization} rpi: alpha over the fourth power of the largest eigenvalue, or `paper` for the third \
         power of that eigenvalue, which depends on the unit of length",
    )
    .of(is_regularized).advanced(),
    parsed::<Bandwidth>(
        OptionGroup::Method,
        "sigma",
        "mean|median|max|WIDTH",
        "mean",
        "Kernel width of kpca, in mesh units or as a statistic of the measured distances",
    )
    .of(|m| matches!(m, EmbedMethod::KernelPca { .. })).advanced(),
    parsed::<usize>(
        OptionGroup::Method,
        "eigenvectors",
        "M",
        "300",
        "Number of Laplace-Beltrami eigenfunctions for spectral",
    )
    .called("n_eigenfunctions")
    .of(is_spectral).advanced(),
    parsed::<f64>(
        OptionGroup::Method,
        "mu",
        "MU",
        "1000",
        "Weight of the distances against smoothness in spectral, for a surface of unit area; `inf` fits the \
         distances exactly",
    )
    .of(is_spectral).advanced(),
    parsed::<usize>(OptionGroup::Method, "iterations", "N", "300", "Maximum number of smacof steps")
        .called("max_iterations")
        .of(is_smacof).advanced(),
    parsed::<f64>(
        OptionGroup::Method,
        "tolerance",
        "T",
        "1e-6",
        "Stop smacof when a step reduces the stress by less than this fraction",
    )
    .of(is_smacof).advanced(),
    named::<StressChoice>(OptionGroup::Stress, "stress", "auto", "How to find the stress; see below for its formulas"),
    parsed::<usize>(
        OptionGroup::Description,
        "points",
        "POINTS",
        "1000",
        "Number of points of each form to keep for alignment",
    )
    .called("n_points"),
    parsed::<bool>(
        OptionGroup::Description,
        "size",
        "",
        "",
        "Distinguish shapes by size: all meshes have the same unit of length",
    ),
    parsed::<usize>(
        OptionGroup::Maps,
        "eigenfunctions",
        "K",
        "150",
        "Most eigenfunctions of each surface that the map is refined with",
    ),
];

/// An option whose values are chosen by name.
const fn named<T: Named>(
    group: OptionGroup,
    name: &'static str,
    default: &'static str,
    help: &'static str,
) -> OptionSpec {
    OptionSpec {
        name,
        keyword: name,
        group,
        placeholder: "",
        default,
        is_advanced: false,
        help,
        names: || T::table().into_iter().map(|(name, help, _)| (name, help)).collect(),
        check: check_name::<T>,
        applies: |_| true,
    }
}

/// An option whose values are parsed.
const fn parsed<T: FromStr<Err: Display>>(
    group: OptionGroup,
    name: &'static str,
    placeholder: &'static str,
    default: &'static str,
    help: &'static str,
) -> OptionSpec {
    OptionSpec {
        name,
        keyword: name,
        group,
        placeholder,
        default,
        is_advanced: false,
        help,
        names: Vec::new,
        check: |text| text.parse::<T>().map(drop).map_err(|fault| fault.to_string()),
        applies: |_| true,
    }
}

fn check_name<T: Named>(text: &str) -> Result<(), String> {
    let names = || T::table().into_iter().map(|(name, ..)| format!("{name:?}")).collect::<Vec<_>>();
    T::named(text).map(drop).ok_or_else(|| format!("use {}", names().join(", ")))
}

impl OptionSpec {
    /// The same option, for some methods only.
    const fn of(self, applies: fn(&EmbedMethod) -> bool) -> Self {
        Self { applies, ..self }
    }

    /// The same option, with another name in Python.
    const fn called(self, keyword: &'static str) -> Self {
        Self { keyword, ..self }
    }

    /// The same option, which few users need.
    const fn advanced(self) -> Self {
        Self { is_advanced: true, ..self }
    }

    /// The option of this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SCHEMA.iter().find(|option| option.name == name)
    }

    /// The values that are chosen by name, each with a line of help; empty if values are numbers or texts.
    pub fn names(&self) -> Vec<(&'static str, &'static str)> {
        (self.names)()
    }

    /// Whether the option is on or off, and has no other value.
    pub fn is_switch(&self) -> bool {
        self.placeholder.is_empty() && self.names().is_empty()
    }

    /// Whether a form by this method depends on the option.
    pub fn applies_to(&self, method: &EmbedMethod) -> bool {
        (self.applies)(method)
    }

    /// What the option does, and its default, with other options as `spell` writes them.
    pub fn help(&self, spell: impl Fn(&str) -> String) -> String {
        let default = format!(" [default: {}]", self.default);
        let (first, rest) = self.help.split_once("\n\n").unwrap_or((self.help, ""));
        let shown = if self.default.is_empty() || !rest.is_empty() { "" } else { default.as_str() };
        let mut help = format!("{first}{shown}");
        if !rest.is_empty() {
            help += &format!("\n\n{rest}");
        }
        let mut words = String::new();
        for part in help.split('{') {
            match part.split_once('}') {
                Some((name, after)) => words += &(spell(name) + after),
                None => words += part,
            }
        }
        words
    }

    /// Checks a value.
    ///
    /// # Errors
    /// What values are possible.
    pub fn check(&self, text: &str) -> Result<(), String> {
        (self.check)(text)
    }
}

fn is_regularized(method: &EmbedMethod) -> bool {
    method.regularization().is_some()
}

fn is_spectral(method: &EmbedMethod) -> bool {
    matches!(method, EmbedMethod::Spectral { .. })
}

fn is_smacof(method: &EmbedMethod) -> bool {
    matches!(method, EmbedMethod::Smacof { .. })
}

impl Named for EmbedMethod {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        Self::all().map(|m| (m.name(), m.summary(), m)).into()
    }
}

impl Named for Method {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        Self::all().map(|m| (m.name(), m.summary(), m)).into()
    }
}

impl Named for Sampling {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        Self::ALL.map(|s| (s.name(), s.summary(), s)).into()
    }
}

impl Named for Regularization {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        Self::all().map(|r| (r.name(), r.summary(), r)).into()
    }
}

impl Named for Update {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        vec![
            ("virtual-source", "Triangles hand on where the source lies in their plane", Self::VirtualSource),
            ("planar", "The front in a triangle is a straight line (Kimmel and Sethian)", Self::Planar),
        ]
    }
}

impl Named for ObtuseTreatment {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        vec![
            ("flip", "Flip interior edges until few are left", Self::Flip),
            ("unfold", "Unfold the surface across the angle and split it (Kimmel and Sethian)", Self::Unfold),
            ("ignore", "Treat them like any other", Self::Ignore),
        ]
    }
}

impl Named for ComponentPolicy {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        vec![
            ("largest", "Keep the component with the largest area", Self::Largest),
            ("bridge", "Join the components by links, all along narrow gaps", Self::Bridge),
            ("error", "Refuse the mesh", Self::Error),
        ]
    }
}

impl Named for StressChoice {
    fn table() -> Vec<(&'static str, &'static str, Self)> {
        vec![
            (
                "auto",
                "Exactly where the method measures all pairs, else from one row for every 7 samples, at least 3, or 32 \
                 with samples chosen automatically",
                Self::Auto,
            ),
            ("exact", "From the distances between all pairs of vertices", Self::Exact),
            ("estimate", "From the distances of 100 vertices to all others", Self::Estimate),
            ("skip", "Not at all", Self::Skip),
        ]
    }
}
