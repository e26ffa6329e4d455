//! Settings as users give them: flags of a program, or keyword arguments.
//!
//! Every option is declared here, once, in the group that commands combine. A field is named as the keyword of Python. With the
//! feature `clap` it is also a flag, with its documentation as help.

use descriptors::Normalization;
use geodesics::{FastMarchingOptions, FirstSample, Method, ObtuseTreatment, Sampling, Update};
use mesh::{ComponentPolicy, Orient, RepairOptions, Weld};
use nmds::{Bandwidth, Regularization, RpiAlpha, SmacofOptions, SpectralBasis};
use serde::Deserialize;
use strum::{EnumMessage, IntoStaticStr, VariantArray};
use surface::VertexId;

use super::as_text;
use super::distances::Samples;
use super::method::{EIGENVECTORS, EmbedMethod};
use super::options::{DescribeOptions, FormOptions};
use super::stress::StressChoice;
use crate::correspond::CorrespondOptions;

/// A method of embedding, without its options.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, IntoStaticStr, EnumMessage, VariantArray,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum EmbeddingName {
    /// Nystrom multidimensional scaling
    #[default]
    Nmds,
    /// Landmark MDS: embed the samples, place the rest by their distances to them
    Landmark,
    /// Spectral scaling: distances between samples, in eigenfunctions of the surface
    Spectral,
    /// Kernel PCA with the Nystrom method
    Kpca,
    /// Classical multidimensional scaling of all pairs
    Mds,
    /// SMACOF on all pairs, started from the result of nmds
    Smacof,
}

/// A method of measuring distances, without its options.
#[derive(
    Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, IntoStaticStr, EnumMessage, VariantArray,
)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Geodesic {
    /// Fast marching on triangles
    #[default]
    FastMarching,
    /// Exact on the polyhedral surface
    Exact,
    /// Heat method: smooth, fast for many sources
    Heat,
    /// Shortest paths along edges
    Dijkstra,
    /// Number of edges times the mean edge length
    Bfs,
}

/// How the sample matrix is inverted, without the options of that.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, IntoStaticStr)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum Inverse {
    /// Keep the eigenvalues of largest magnitude
    #[default]
    LowRank,
    /// Keep all eigenvalues and damp the small ones (regularized pseudo-inverse)
    Rpi,
    /// Keep all eigenvalues above rounding error
    None,
    /// CUR decomposition: keep the columns of the first samples
    Cur,
}

/// What every form needs.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Embedding"))]
#[serde(default)]
pub struct FormSettings {
    /// Number of samples, or `auto` to take as many as needed [default: 100]
    #[cfg_attr(feature = "clap", arg(short = 'n', long = "samples", value_name = "SAMPLES|auto"))]
    #[serde(deserialize_with = "as_text::given")]
    pub n_landmarks: Option<Samples>,
    /// Dimensions of the embedding [default: 3]
    #[cfg_attr(feature = "clap", arg(long = "dim", value_name = "K"))]
    pub n_components: Option<usize>,
    /// How to measure distances [default: fast-marching]
    #[cfg_attr(feature = "clap", arg(long))]
    pub geodesic: Option<Geodesic>,
}

/// Options of fast marching.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Fast marching"))]
#[serde(default)]
pub struct MarchingSettings {
    /// Local solver [default: virtual-source]
    #[cfg_attr(feature = "clap", arg(long, hide_short_help = true))]
    pub update: Option<Update>,
    /// What to do about angles wider than 90 degrees [default: flip]
    #[cfg_attr(feature = "clap", arg(long, hide_short_help = true))]
    pub obtuse: Option<ObtuseTreatment>,
}

/// How meshes are repaired.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Repair"))]
#[serde(default)]
pub struct RepairSettings {
    /// What to do with a mesh of several components [default: largest]
    #[cfg_attr(feature = "clap", arg(long))]
    pub components: Option<ComponentPolicy>,
    /// Which vertices to merge: `seams` on boundaries (the default), `all`, `none`, or a distance
    ///
    /// `seams` merges boundary vertices in the same position, and boundary edges that nearly coincide: those whose ends are
    /// within 2 % of the shortest side of their faces. A number merges boundary vertices within this distance, in mesh units.
    /// `all` merges all vertices in the same position. Two vertices of one edge are never merged.
    #[cfg_attr(feature = "clap", arg(long, value_name = "seams|all|none|TOL"))]
    #[serde(deserialize_with = "as_text::given")]
    pub weld: Option<Weld>,
}

/// Which method makes coordinates of distances, and the options of methods.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args), command(next_help_heading = "Embedding"))]
#[serde(default)]
pub struct MethodSettings {
    /// How to turn distances into coordinates [default: nmds]
    #[cfg_attr(feature = "clap", arg(long))]
    pub method: Option<EmbeddingName>,
    /// Number of eigenpairs of the sample matrix to keep (of columns for cur) [default: half the samples, at least --dim + 4]
    #[cfg_attr(feature = "clap", arg(long, value_name = "N1", hide_short_help = true))]
    pub rank: Option<usize>,
    /// How to choose samples [default: farthest]
    #[cfg_attr(feature = "clap", arg(long, hide_short_help = true))]
    pub sampling: Option<Sampling>,
    /// First sample, a vertex of the input [default: the vertex farthest from vertex 0; with other samplings, drawn with --seed]
    #[cfg_attr(feature = "clap", arg(long = "first-sample", value_name = "V", hide_short_help = true))]
    pub first: Option<u32>,
    /// How nmds, and the start of smacof, regularize the inverse of the sample matrix [default: low-rank]
    #[cfg_attr(feature = "clap", arg(long, hide_short_help = true))]
    pub regularization: Option<Inverse>,
    /// For --regularization rpi: alpha over the fourth power of the largest eigenvalue, or `paper` for the third power of that
    /// eigenvalue, which depends on the unit of length [default: 1e-10]
    #[cfg_attr(feature = "clap", arg(long, value_name = "C|paper", hide_short_help = true))]
    #[serde(deserialize_with = "as_text::given")]
    pub alpha: Option<RpiAlpha>,
    /// Kernel width of kpca, in mesh units or as a statistic of the measured distances [default: mean]
    #[cfg_attr(feature = "clap", arg(long, value_name = "mean|median|max|WIDTH", hide_short_help = true))]
    #[serde(deserialize_with = "as_text::given")]
    pub sigma: Option<Bandwidth>,
    /// Number of Laplace-Beltrami eigenfunctions for spectral [default: 300]
    #[cfg_attr(feature = "clap", arg(long = "eigenvectors", value_name = "M", hide_short_help = true))]
    pub n_eigenfunctions: Option<usize>,
    /// Weight of the distances against smoothness in spectral, for a surface of unit area; `inf` fits the distances exactly
    /// [default: 1000]
    #[cfg_attr(feature = "clap", arg(long, value_name = "MU", hide_short_help = true))]
    #[serde(deserialize_with = "as_text::given")]
    pub mu: Option<f64>,
    /// Maximum number of smacof steps [default: 300]
    #[cfg_attr(feature = "clap", arg(long = "iterations", value_name = "N", hide_short_help = true))]
    pub max_iterations: Option<usize>,
    /// Stop smacof when a step reduces the stress by less than this fraction [default: 1e-6]
    #[cfg_attr(feature = "clap", arg(long, value_name = "T", hide_short_help = true))]
    pub tolerance: Option<f64>,
}

/// How the stress is found.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct StressSettings {
    /// How to find the stress; see below for its formulas [default: auto]
    #[cfg_attr(feature = "clap", arg(long))]
    pub stress: Option<StressChoice>,
}

/// What is kept of a form.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct DescriptionSettings {
    /// Number of points of each form to keep for alignment [default: 1000]
    #[cfg_attr(feature = "clap", arg(long = "points", value_name = "POINTS"))]
    pub n_points: Option<usize>,
    /// Distinguish shapes by size: all meshes have the same unit of length
    #[cfg_attr(feature = "clap", arg(long))]
    pub size: bool,
}

/// How surfaces are mapped.
#[derive(Debug, Clone, Default, PartialEq, Deserialize)]
#[cfg_attr(feature = "clap", derive(clap::Args))]
#[serde(default)]
pub struct MapSettings {
    /// Most eigenfunctions of each surface that the map is refined with [default: 150]
    #[cfg_attr(feature = "clap", arg(long, value_name = "K"))]
    pub eigenfunctions: Option<usize>,
}

/// A setting that would change nothing beside another one. Settings are named as their fields.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NoEffect {
    /// Name of the setting.
    pub setting: &'static str,
    /// Name of the other setting.
    pub beside: &'static str,
    /// Value of the other setting.
    pub value: &'static str,
    /// Values of the other setting with which the setting has an effect.
    pub instead: Vec<&'static str>,
}

impl NoEffect {
    /// Refuses a setting that was given, unless the other setting has one of the values with which it has an effect.
    fn check<T: Copy + PartialEq + Into<&'static str>>(
        (setting, is_given, instead): (&'static str, bool, &[T]),
        (beside, value): (&'static str, T),
    ) -> Result<(), Self> {
        if !is_given || instead.contains(&value) {
            return Ok(());
        }
        let instead = instead.iter().map(|&value| value.into()).collect();
        Err(Self { setting, beside, value: value.into(), instead })
    }

    /// The message, with settings as `spell` writes them: a name, and the values that it may have, or none.
    pub fn in_words(&self, spell: impl Fn(&str, &[&str]) -> String) -> String {
        let (setting, with) = (spell(self.setting, &[]), spell(self.beside, &[self.value]));
        let instead = spell(self.beside, &self.instead);
        format!("{setting} has no effect with {with}; leave it out, or use {instead}")
    }
}

impl MethodSettings {
    /// Refuses settings that would change nothing.
    fn check(&self) -> Result<(), NoEffect> {
        use EmbeddingName::{Kpca, Landmark, Nmds, Smacof, Spectral};
        let method = ("method", self.method.unwrap_or_default());
        let sampled = [Nmds, Landmark, Spectral, Kpca, Smacof];
        NoEffect::check(("sampling", self.sampling.is_some(), &sampled), method)?;
        NoEffect::check(("first", self.first.is_some(), &sampled), method)?;
        NoEffect::check(("rank", self.rank.is_some(), &[Nmds, Kpca, Smacof]), method)?;
        NoEffect::check(("regularization", self.regularization.is_some(), &[Nmds, Smacof]), method)?;
        NoEffect::check(("alpha", self.alpha.is_some(), &[Nmds, Smacof]), method)?;
        NoEffect::check(("sigma", self.sigma.is_some(), &[Kpca]), method)?;
        NoEffect::check(("n_eigenfunctions", self.n_eigenfunctions.is_some(), &[Spectral]), method)?;
        NoEffect::check(("mu", self.mu.is_some(), &[Spectral]), method)?;
        NoEffect::check(("max_iterations", self.max_iterations.is_some(), &[Smacof]), method)?;
        NoEffect::check(("tolerance", self.tolerance.is_some(), &[Smacof]), method)?;
        if method.1 == Kpca {
            return Ok(());
        }
        let inverse = ("regularization", self.regularization.unwrap_or_default());
        NoEffect::check(("rank", self.rank.is_some(), &[Inverse::LowRank, Inverse::Cur]), inverse)?;
        NoEffect::check(("alpha", self.alpha.is_some(), &[Inverse::Rpi]), inverse)
    }

    /// The method with its options.
    ///
    /// # Errors
    /// [`NoEffect`] if a setting was given that would change nothing.
    pub fn options(&self) -> Result<EmbedMethod, NoEffect> {
        self.check()?;
        let rank = self.rank;
        let regularization = match self.regularization.unwrap_or_default() {
            Inverse::LowRank => Regularization::LowRank { rank },
            Inverse::Rpi => Regularization::Rpi { alpha: self.alpha.unwrap_or_default() },
            Inverse::None => Regularization::None,
            Inverse::Cur => Regularization::Cur { rank },
        };
        let usual = SmacofOptions::default();
        Ok(match self.method.unwrap_or_default() {
            EmbeddingName::Nmds => EmbedMethod::Nystrom { regularization },
            EmbeddingName::Landmark => EmbedMethod::Landmark,
            EmbeddingName::Spectral => EmbedMethod::Spectral {
                eigenvectors: self.n_eigenfunctions.unwrap_or(EIGENVECTORS),
                mu: self.mu.unwrap_or(SpectralBasis::MU),
            },
            EmbeddingName::Kpca => EmbedMethod::KernelPca { rank, bandwidth: self.sigma.unwrap_or_default() },
            EmbeddingName::Mds => EmbedMethod::Classical,
            EmbeddingName::Smacof => EmbedMethod::Smacof {
                regularization,
                descent: SmacofOptions {
                    max_iterations: self.max_iterations.unwrap_or(usual.max_iterations),
                    tolerance: self.tolerance.unwrap_or(usual.tolerance),
                },
            },
        })
    }
}

impl MarchingSettings {
    /// The method with its options.
    ///
    /// # Errors
    /// [`NoEffect`] if one of these was given beside another method than fast marching.
    pub fn method(&self, geodesic: Geodesic) -> Result<Method, NoEffect> {
        let beside = ("geodesic", geodesic);
        NoEffect::check(("update", self.update.is_some(), &[Geodesic::FastMarching]), beside)?;
        NoEffect::check(("obtuse", self.obtuse.is_some(), &[Geodesic::FastMarching]), beside)?;
        Ok(match geodesic {
            Geodesic::FastMarching => Method::FastMarching(FastMarchingOptions {
                update: self.update.unwrap_or_default(),
                obtuse: self.obtuse.unwrap_or_default(),
            }),
            Geodesic::Exact => Method::Exact,
            Geodesic::Heat => Method::Heat(Default::default()),
            Geodesic::Dijkstra => Method::Dijkstra,
            Geodesic::Bfs => Method::BreadthFirst,
        })
    }
}

impl RepairSettings {
    /// How a mesh is repaired.
    pub fn options(&self) -> RepairOptions {
        let components = self.components.unwrap_or_default();
        RepairOptions { components, weld: self.weld.unwrap_or_default(), orient: Orient::Keep }
    }
}

impl FormSettings {
    /// How a form is made, with seed 0.
    ///
    /// # Errors
    /// [`NoEffect`] if a setting of a method was given that would change nothing.
    pub fn options(
        &self,
        method: &MethodSettings,
        marching: &MarchingSettings,
        repair: &RepairSettings,
    ) -> Result<FormOptions, NoEffect> {
        let first = method.first.map(|v| FirstSample::Vertex(VertexId(v)));
        let usual = FormOptions::default();
        Ok(FormOptions {
            repair: repair.options(),
            geodesic: marching.method(self.geodesic.unwrap_or_default())?,
            samples: self.n_landmarks.unwrap_or_default(),
            sampling: method.sampling.unwrap_or_default(),
            first_sample: first.unwrap_or_default(),
            method: method.options()?,
            dim: self.n_components.unwrap_or(usual.dim),
            seed: usual.seed,
        })
    }
}

impl MapSettings {
    /// How surfaces of such forms are mapped.
    pub fn options(&self, form: FormOptions) -> CorrespondOptions {
        let mut options = CorrespondOptions { form, ..CorrespondOptions::default() };
        if let Some(most) = self.eigenfunctions {
            options.maps.eigenfunctions = most;
        }
        options
    }
}

impl DescriptionSettings {
    /// How shapes of such forms are described.
    pub fn options(&self, form: FormOptions) -> DescribeOptions {
        let usual = DescribeOptions::default();
        let size = if self.size { Normalization::Raw } else { usual.size };
        DescribeOptions { form, points: self.n_points.unwrap_or(usual.points), size }
    }
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    fn of<T: serde::de::DeserializeOwned>(given: Value) -> T {
        serde_json::from_value(given).unwrap()
    }

    #[test]
    fn no_settings_are_the_default_options() {
        let (form, description) = (FormSettings::default(), DescriptionSettings::default());
        let form = form.options(&Default::default(), &Default::default(), &Default::default()).unwrap();
        assert_eq!(description.options(form.clone()), DescribeOptions::default());
        assert_eq!(MapSettings::default().options(form), CorrespondOptions::default());
    }

    #[test]
    fn methods_have_one_name_in_settings_and_in_options() {
        for method in EmbedMethod::all() {
            let settings: MethodSettings = of(json!({ "method": method.name() }));
            assert!(serde_json::to_string(&method).unwrap().contains(&format!("\"{}\"", method.name())));
            assert_eq!(settings.options(), Ok(method));
        }
        for regularization in Regularization::all() {
            let settings: MethodSettings = of(json!({ "regularization": regularization.name() }));
            assert_eq!(settings.options(), Ok(EmbedMethod::Nystrom { regularization }));
        }
        for method in Method::all() {
            let FormSettings { geodesic, .. } = of(json!({ "geodesic": method.name() }));
            assert_eq!(MarchingSettings::default().method(geodesic.unwrap()), Ok(method));
        }
    }

    #[test]
    fn impossible_values_are_refused_with_what_is_possible() {
        fn refused<T: serde::de::DeserializeOwned>(given: Value, words: &str) {
            let fault = serde_json::from_value::<T>(given.clone()).err().unwrap().to_string();
            assert!(fault.contains(words), "{given}: {fault}");
        }
        refused::<MethodSettings>(json!({"method": "umap"}), "expected one of `nmds`, `landmark`");
        refused::<MethodSettings>(json!({"alpha": "ten"}), "neither a number nor `paper`");
        refused::<MethodSettings>(json!({"sigma": "wide"}), "`mean`");
        refused::<MethodSettings>(json!({"sigma": true}), "neither a number nor a word");
        refused::<MethodSettings>(json!({"rank": 1.5}), "expected usize");
        refused::<RepairSettings>(json!({"weld": -1}), "distance in mesh units");
        refused::<FormSettings>(json!({"n_landmarks": 0}), "`auto`");
    }

    #[test]
    fn settings_without_effect_are_refused_with_what_would_use_them() {
        for (given, [setting, beside, instead]) in [
            (json!({"mu": 5}), ["mu", "method", "spectral"]),
            (json!({"alpha": "paper"}), ["alpha", "regularization", "rpi"]),
            (json!({"rank": 5, "regularization": "none"}), ["rank", "regularization", "low-rank"]),
            (json!({"rank": 5, "method": "landmark"}), ["rank", "method", "nmds"]),
            (json!({"first": 1, "method": "mds"}), ["first", "method", "nmds"]),
        ] {
            let fault = of::<MethodSettings>(given).options().unwrap_err();
            assert_eq!((fault.setting, fault.beside, fault.instead[0]), (setting, beside, instead));
            let words = fault.in_words(|name, values| format!("<{name}={}>", values.join("|")));
            assert!(words.starts_with(&format!("<{setting}=>")), "{words}");
            assert!(words.contains(&format!("or use <{beside}={instead}")), "{words}");
        }
        let fault = of::<MarchingSettings>(json!({"obtuse": "flip"})).method(Geodesic::Heat).unwrap_err();
        assert_eq!((fault.setting, fault.beside, fault.value), ("obtuse", "geodesic", "heat"));
    }
}
