//! How a surface is embedded: the methods, and which options belong to which.

use anyhow::{Result, anyhow};
use canonform::geodesics::Sampling;
use canonform::nmds::{Bandwidth, Regularization, RpiAlpha};
use canonform::{EmbedMethod, EmbedSettings, FormOptions};
use clap::Args;
use clap::builder::TypedValueParser;

use super::shared::{Common, FormArgs, one_of};

/// Everything that decides the form of a surface.
#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Embedding")]
pub(crate) struct EmbeddingArgs {
    /// How to turn distances into coordinates
    #[arg(long, value_parser = method(), default_value = EmbedMethod::default().name())]
    pub(crate) method: EmbedMethod,
    #[command(flatten)]
    pub(crate) form: FormArgs,
    /// Number of eigenpairs of the sample matrix to keep (of columns for cur) [default: half the samples, at least
    /// --dim + 4]
    #[arg(long, value_name = "N1")]
    pub(crate) rank: Option<usize>,
    /// How to choose samples [default: farthest]
    #[arg(long, value_parser = sampling())]
    pub(crate) sampling: Option<Sampling>,
    /// First sample, a vertex of the input [default: the vertex farthest from vertex 0; with other samplings,
    /// drawn with --seed]
    #[arg(long, value_name = "V")]
    pub(crate) first_sample: Option<u32>,
    /// How nmds, and the start of smacof, regularise the inverse of the sample matrix [default: low-rank]
    #[arg(long, value_parser = regularization())]
    pub(crate) regularization: Option<Regularization>,
    /// For --regularization rpi: alpha over the fourth power of the largest eigenvalue, or `paper` for the third
    /// power of that eigenvalue, which depends on the unit of length [default: 1e-10]
    #[arg(long, value_name = "C|paper", value_parser = parse_alpha)]
    pub(crate) alpha: Option<RpiAlpha>,
    /// Kernel width of kpca, in mesh units or as a statistic of the measured distances [default: mean]
    #[arg(long, value_name = "mean|median|max|WIDTH", value_parser = parse_bandwidth)]
    pub(crate) sigma: Option<Bandwidth>,
    /// Number of Laplace-Beltrami eigenfunctions for spectral [default: 300]
    #[arg(long, value_name = "M")]
    pub(crate) eigenvectors: Option<usize>,
    /// Weight of the distances against smoothness in spectral, for a surface of unit area; `inf` fits the
    /// distances exactly [default: 1000]
    #[arg(long, value_name = "MU")]
    pub(crate) mu: Option<f64>,
    /// Maximum number of smacof steps [default: 300]
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<usize>,
    /// Stop smacof when a step reduces the stress by less than this fraction [default: 1e-6]
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
}

fn method() -> impl TypedValueParser<Value = EmbedMethod> {
    one_of(EmbedMethod::all().map(|m| (m.name(), m.summary(), m)))
}

fn sampling() -> impl TypedValueParser<Value = Sampling> {
    one_of(Sampling::ALL.map(|s| (s.name(), s.summary(), s)))
}

fn regularization() -> impl TypedValueParser<Value = Regularization> {
    one_of(Regularization::all().map(|r| (r.name(), r.summary(), r)))
}

impl EmbeddingArgs {
    /// # Errors
    /// Options that do not apply together.
    pub(crate) fn options(&self, common: &Common) -> Result<FormOptions> {
        self.options_with_target(common, None)
    }

    /// As [`options`](Self::options), with the normalised stress up to which samples are taken.
    pub(crate) fn options_with_target(
        &self,
        common: &Common,
        target_stress: Option<f64>,
    ) -> Result<FormOptions> {
        let settings = EmbedSettings {
            method: self.method.clone(),
            regularization: self.regularization,
            rank: self.rank,
            alpha: self.alpha,
            sampling: self.sampling,
            target_stress,
            first_sample: self.first_sample,
            sigma: self.sigma,
            eigenvectors: self.eigenvectors,
            mu: self.mu,
            iterations: self.iterations,
            tolerance: self.tolerance,
        };
        let options = settings.applied_to(self.form.options(common));
        options.map_err(|fault| anyhow!(fault.in_words(spelled)))
    }
}

/// A setting as an option of the command line.
fn spelled(setting: &str, values: &[&str]) -> String {
    format!("--{} {}", setting.replace('_', "-"), values.join(" or ")).trim_end().to_owned()
}

fn parse_alpha(text: &str) -> Result<RpiAlpha, String> {
    match text.parse() {
        _ if text == "paper" => Ok(RpiAlpha::Paper),
        Ok(c) => Ok(RpiAlpha::Relative(c)),
        Err(_) => Err(format!("`{text}` is neither a number nor `paper`")),
    }
}

fn parse_bandwidth(text: &str) -> Result<Bandwidth, String> {
    match (text, text.parse()) {
        ("mean", _) => Ok(Bandwidth::Mean),
        ("median", _) => Ok(Bandwidth::Median),
        ("max", _) => Ok(Bandwidth::Max),
        (_, Ok(sigma)) => Ok(Bandwidth::Value(sigma)),
        (_, Err(_)) => Err(format!("`{text}` is neither a number nor `mean`, `median` or `max`")),
    }
}
