//! How a surface is embedded: methods, and which options belong to which.

use anyhow::{Result, bail};
use canonform::{
    Bandwidth, EmbedMethod, EmbedOptions, FirstSample, Regularization, RpiAlpha, Samples, Sampling,
    SmacofOptions, StressChoice, Variance,
};
use clap::{Args, ValueEnum};
use surface::VertexId;

use super::{Common, GeodesicName, MarchingArgs, RepairArgs};

/// How a surface is embedded.
#[derive(Debug, Clone, Args)]
pub(crate) struct EmbeddingArgs {
    /// How distances become coordinates
    #[arg(long, value_enum, default_value_t = MethodName::Nmds)]
    pub(crate) method: MethodName,
    /// Number of samples, or `auto` to take as many as it needs [default: 100]
    #[arg(short = 'n', long, value_name = "SAMPLES|auto", value_parser = parse_samples)]
    pub(crate) samples: Option<Samples>,
    /// Eigenpairs of the sample matrix to keep (columns, for cur) [default: half the samples, at least 4
    /// more than dimensions]
    #[arg(long, value_name = "N1")]
    pub(crate) rank: Option<usize>,
    /// Dimensions of the embedding
    #[arg(long, default_value_t = 3, value_name = "K")]
    pub(crate) dim: usize,
    /// How samples are taken [default: farthest]
    #[arg(long, value_enum)]
    pub(crate) sampling: Option<SamplingName>,
    /// First sample, a vertex of the input [default: the vertex farthest from the first; drawn with --seed
    /// by random and min-variance]
    #[arg(long, value_name = "V")]
    pub(crate) first_sample: Option<u32>,
    /// What takes the place of the inverse of the sample matrix, in nmds and the start of smacof [default:
    /// low-rank]
    #[arg(long, value_enum)]
    pub(crate) regularization: Option<RegularizationName>,
    /// Of --regularization rpi: alpha over the fourth power of the largest eigenvalue, or `paper` for the third
    /// power of that eigenvalue, which depends on the unit of length [default: 1e-10]
    #[arg(long, value_name = "C|paper", value_parser = parse_alpha)]
    pub(crate) alpha: Option<RpiAlpha>,
    /// Width of the kernel of kpca, in mesh units or as a statistic of the measured distances [default: mean]
    #[arg(long, value_name = "mean|median|max|WIDTH", value_parser = parse_bandwidth)]
    pub(crate) sigma: Option<Bandwidth>,
    /// Eigenfunctions of the Laplace-Beltrami operator for spectral [default: 300]
    #[arg(long, value_name = "M")]
    pub(crate) eigenvectors: Option<usize>,
    /// Weight of the distances against smoothness in spectral, for a surface of unit area; `inf` fits the
    /// distances exactly [default: 1000]
    #[arg(long, value_name = "MU")]
    pub(crate) mu: Option<f64>,
    /// Steps of smacof at most [default: 300]
    #[arg(long, value_name = "N")]
    pub(crate) iterations: Option<usize>,
    /// Share of the stress that a step of smacof must gain for another one to follow [default: 1e-6]
    #[arg(long, value_name = "T")]
    pub(crate) tolerance: Option<f64>,
    /// How distances are measured
    #[arg(long, value_enum, default_value_t = GeodesicName::FastMarching, value_name = "METHOD")]
    pub(crate) geodesic: GeodesicName,
    #[command(flatten)]
    pub(crate) marching: MarchingArgs,
    #[command(flatten)]
    pub(crate) repair: RepairArgs,
}

impl EmbeddingArgs {
    /// The options, unless some of them do not apply together.
    pub(crate) fn options(&self, common: &Common, stress: StressChoice) -> Result<EmbedOptions> {
        self.check()?;
        let rank = self.rank;
        let regularization = match self.regularization.unwrap_or(RegularizationName::LowRank) {
            RegularizationName::LowRank => Regularization::LowRank { rank },
            RegularizationName::Rpi => Regularization::Rpi { alpha: self.alpha.unwrap_or_default() },
            RegularizationName::None => Regularization::None,
            RegularizationName::Cur => Regularization::Cur { rank },
        };
        let usual = SmacofOptions::default();
        let descent = SmacofOptions {
            max_iterations: self.iterations.unwrap_or(usual.max_iterations),
            tolerance: self.tolerance.unwrap_or(usual.tolerance),
        };
        let usual = EmbedOptions::default();
        Ok(EmbedOptions {
            geodesic: self.geodesic.method(self.marching),
            samples: self.samples.unwrap_or(usual.samples),
            sampling: match self.sampling.unwrap_or(SamplingName::Farthest) {
                SamplingName::Farthest => Sampling::Farthest,
                SamplingName::Random => Sampling::Random,
                SamplingName::MinVariance => Sampling::Incremental(Variance::Least),
            },
            first_sample: match self.first_sample {
                Some(vertex) => FirstSample::Vertex(VertexId(vertex)),
                None => FirstSample::Farthest,
            },
            method: match self.method {
                MethodName::Nmds => EmbedMethod::Nystrom { regularization },
                MethodName::Mds => EmbedMethod::Classical,
                MethodName::Landmark => EmbedMethod::Landmark,
                MethodName::Spectral => self.spectral(),
                MethodName::Fmds => EmbedMethod::Fmds,
                MethodName::Kpca => {
                    EmbedMethod::KernelPca { rank, bandwidth: self.sigma.unwrap_or_default() }
                }
                MethodName::Smacof => EmbedMethod::Smacof { regularization, descent },
            },
            dim: self.dim,
            stress,
            seed: common.seed,
            ..usual
        })
    }

    fn spectral(&self) -> EmbedMethod {
        match EmbedMethod::spectral() {
            EmbedMethod::Spectral { eigenvectors, mu } => EmbedMethod::Spectral {
                eigenvectors: self.eigenvectors.unwrap_or(eigenvectors),
                mu: self.mu.unwrap_or(mu),
            },
            other => other,
        }
    }

    /// Refuses options that would have no effect.
    fn check(&self) -> Result<()> {
        use MethodName::{Fmds, Kpca, Landmark, Nmds, Smacof, Spectral};
        let sampled: &[MethodName] = &[Nmds, Landmark, Spectral, Fmds, Kpca, Smacof];
        let of_method: [(&str, bool, &[MethodName]); 9] = [
            ("--rank", self.rank.is_some(), &[Nmds, Kpca, Smacof]),
            ("--sampling", self.sampling.is_some(), sampled),
            ("--first-sample", self.first_sample.is_some(), sampled),
            ("--regularization", self.regularization.is_some(), &[Nmds, Smacof]),
            ("--eigenvectors", self.eigenvectors.is_some(), &[Spectral]),
            ("--mu", self.mu.is_some(), &[Spectral]),
            ("--sigma", self.sigma.is_some(), &[Kpca]),
            ("--iterations", self.iterations.is_some(), &[Smacof]),
            ("--tolerance", self.tolerance.is_some(), &[Smacof]),
        ];
        for (option, is_given, methods) in of_method {
            if is_given && !methods.contains(&self.method) {
                bail!(
                    "{option} has no effect on --method {}; leave it out, or take --method {}",
                    name(self.method),
                    methods.iter().map(|method| name(*method)).collect::<Vec<_>>().join(" or ")
                );
            }
        }
        match self.regularization {
            Some(chosen @ (RegularizationName::Rpi | RegularizationName::None)) if self.rank.is_some() => {
                bail!(
                    "--rank has no effect on --regularization {}, which keeps all eigenpairs; leave it out, or \
                     take --regularization low-rank or cur",
                    name(chosen)
                )
            }
            chosen if self.alpha.is_some() && chosen != Some(RegularizationName::Rpi) => {
                bail!("--alpha belongs to --regularization rpi; add that, or leave --alpha out")
            }
            _ => Ok(()),
        }
    }
}

/// The name of a value on the command line.
fn name(value: impl ValueEnum) -> String {
    value.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

pub(super) fn parse_samples(text: &str) -> Result<Samples, String> {
    match text.parse() {
        _ if text == "auto" => Ok(Samples::Auto),
        Ok(0) | Err(_) => Err(format!("`{text}` is neither a positive number nor `auto`")),
        Ok(n) => Ok(Samples::Count(n)),
    }
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

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum MethodName {
    /// Nystrom multidimensional scaling
    Nmds,
    /// Classical multidimensional scaling of all pairs
    Mds,
    /// Landmark MDS: the samples embedded, the rest placed by its distances to them
    Landmark,
    /// Spectral scaling: distances between samples, in eigenfunctions of the surface
    Spectral,
    /// Fast MDS: distances from samples, smooth on the surface in between
    Fmds,
    /// Kernel PCA with the Nystrom method
    Kpca,
    /// SMACOF on all pairs, from the result of nmds
    Smacof,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum SamplingName {
    /// Each the farthest from those before it
    Farthest,
    /// All vertices with the same chance
    Random,
    /// Each the one whose squared distances to those before it vary least
    MinVariance,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum RegularizationName {
    /// Keep the eigenvalues of largest magnitude
    LowRank,
    /// Keep all, and hold the small ones back (regularised pseudo-inverse)
    Rpi,
    /// Keep all that are not rounding errors
    None,
    /// CUR decomposition: keep the columns of the first samples
    Cur,
}
