//! How a surface is embedded: the methods, and which options belong to which.

use anyhow::{Result, bail};
use canonform::geodesics::{FirstSample, Sampling};
use canonform::nmds::{Bandwidth, Regularization, RpiAlpha};
use canonform::surface::VertexId;
use canonform::{EmbedMethod, FormOptions};
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
        self.check()?;
        let mut method = self.method.clone();
        match &mut method {
            EmbedMethod::Nystrom { regularization } => *regularization = self.regularization(),
            EmbedMethod::Spectral { eigenvectors, mu } => {
                set(eigenvectors, self.eigenvectors);
                set(mu, self.mu);
            }
            EmbedMethod::KernelPca { rank, bandwidth } => {
                *rank = self.rank;
                set(bandwidth, self.sigma);
            }
            EmbedMethod::Smacof { regularization, descent } => {
                *regularization = self.regularization();
                set(&mut descent.max_iterations, self.iterations);
                set(&mut descent.tolerance, self.tolerance);
            }
            EmbedMethod::Classical | EmbedMethod::Landmark | EmbedMethod::Fmds => {}
        }
        let first_sample =
            self.first_sample.map_or(FirstSample::Farthest, |v| FirstSample::Vertex(VertexId(v)));
        let sampling = self.sampling.unwrap_or_default();
        Ok(FormOptions { method, sampling, first_sample, ..self.form.options(common) })
    }

    fn regularization(&self) -> Regularization {
        let mut chosen = self.regularization.unwrap_or_default();
        match &mut chosen {
            Regularization::LowRank { rank } | Regularization::Cur { rank } => *rank = self.rank,
            Regularization::Rpi { alpha } => set(alpha, self.alpha),
            Regularization::None => {}
        }
        chosen
    }

    /// Refuses options that would have no effect.
    fn check(&self) -> Result<()> {
        type AppliesTo = fn(&EmbedMethod) -> bool;
        let of_method: [(&str, bool, AppliesTo); 9] = [
            ("--rank", self.rank.is_some(), |m| {
                m.regularization().is_some() || matches!(m, EmbedMethod::KernelPca { .. })
            }),
            ("--sampling", self.sampling.is_some(), EmbedMethod::is_sampled),
            ("--first-sample", self.first_sample.is_some(), EmbedMethod::is_sampled),
            ("--regularization", self.regularization.is_some(), |m| m.regularization().is_some()),
            ("--eigenvectors", self.eigenvectors.is_some(), |m| matches!(m, EmbedMethod::Spectral { .. })),
            ("--mu", self.mu.is_some(), |m| matches!(m, EmbedMethod::Spectral { .. })),
            ("--sigma", self.sigma.is_some(), |m| matches!(m, EmbedMethod::KernelPca { .. })),
            ("--iterations", self.iterations.is_some(), |m| matches!(m, EmbedMethod::Smacof { .. })),
            ("--tolerance", self.tolerance.is_some(), |m| matches!(m, EmbedMethod::Smacof { .. })),
        ];
        for (option, is_given, applies) in of_method {
            if is_given && !applies(&self.method) {
                let methods = EmbedMethod::all();
                let names: Vec<_> = methods.iter().filter(|m| applies(m)).map(EmbedMethod::name).collect();
                bail!(
                    "{option} has no effect with --method {}; leave it out, or use --method {}",
                    self.method.name(),
                    names.join(" or ")
                );
            }
        }
        match self.regularization {
            Some(chosen @ (Regularization::Rpi { .. } | Regularization::None)) if self.rank.is_some() => {
                bail!(
                    "--rank has no effect with --regularization {}, which keeps all eigenpairs; leave it out, or use \
                     --regularization low-rank or cur",
                    chosen.name()
                )
            }
            chosen if self.alpha.is_some() && !matches!(chosen, Some(Regularization::Rpi { .. })) => {
                bail!("--alpha applies only to --regularization rpi; add that option, or leave out --alpha")
            }
            _ => Ok(()),
        }
    }
}

/// Replaces an option by the value given, if any.
fn set<T: Copy>(option: &mut T, given: Option<T>) {
    *option = given.unwrap_or(*option);
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
