//! The options tree of an embedding.

use geodesics::{FirstSample, Method, Sampling};
use nmds::{Bandwidth, Regularization, SmacofOptions, SpectralOptions};

use crate::PipelineError;

/// How a surface is embedded.
#[derive(Debug, Clone, PartialEq)]
pub struct EmbedOptions {
    /// How distances are measured. Default: fast marching with the point-source update.
    pub geodesic: Method,
    /// Number of samples. Default: 100, as in the paper's Fig. 4.
    pub samples: Samples,
    /// How samples are taken. Default: farthest point sampling, as in the paper.
    pub sampling: Sampling,
    /// The first sample, a vertex of the input. Default: the vertex farthest from the first for farthest point
    /// sampling, drawn for the others.
    pub first_sample: FirstSample,
    /// How distances become coordinates. Default: NMDS.
    pub method: EmbedMethod,
    /// Dimensions of the embedding. Default: 3.
    pub dim: usize,
    /// How the stress is found. Default: [`StressChoice::Auto`].
    pub stress: StressChoice,
    /// How the distances are measured that the stress holds the embedding against. Default: as those that it
    /// was made from. By better ones, poor distances cannot hide behind their own stress.
    pub stress_against: Option<Method>,
    /// Seed of the samples, where they are drawn, and of the rows that an estimated stress is measured on.
    /// Default: 0.
    pub seed: u64,
    /// Most memory for a matrix of all pairs, in bytes. Default: 4 GiB.
    pub all_pairs_limit: usize,
}

impl Default for EmbedOptions {
    fn default() -> Self {
        Self {
            geodesic: Method::default(),
            samples: Samples::Count(100),
            sampling: Sampling::default(),
            first_sample: FirstSample::default(),
            method: EmbedMethod::default(),
            dim: 3,
            stress: StressChoice::default(),
            stress_against: None,
            seed: 0,
            all_pairs_limit: 4 << 30,
        }
    }
}

impl EmbedOptions {
    /// Refuses `n_columns` columns of distances to `n_vertices` vertices that need more than the limit.
    ///
    /// # Errors
    /// [`PipelineError::AllPairsTooLarge`].
    pub(crate) fn check_memory(&self, n_vertices: usize, n_columns: usize) -> Result<(), PipelineError> {
        let needed = n_vertices.saturating_mul(n_columns).saturating_mul(size_of::<f64>());
        if needed <= self.all_pairs_limit {
            return Ok(());
        }
        let [needed_mib, limit_mib] = [needed, self.all_pairs_limit].map(|bytes| bytes >> 20);
        Err(PipelineError::AllPairsTooLarge { n_vertices, needed_mib, limit_mib })
    }
}

/// How many samples are taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Samples {
    /// This many.
    Count(usize),
    /// Doubled from 10 until the stress measured on the samples gains less than 1 %, at most 640.
    Auto,
}

/// How distances become coordinates.
#[derive(Debug, Clone, PartialEq)]
pub enum EmbedMethod {
    /// Nystrom multidimensional scaling, the paper's method.
    Nystrom {
        /// What takes the place of the inverse of the sample matrix. Default: low rank, half the samples.
        regularization: Regularization,
    },
    /// Classical multidimensional scaling of all pairs: the optimum, at quadratic cost.
    Classical,
    /// Landmark MDS: classical scaling of the samples, the other vertices placed by their distances to them.
    Landmark,
    /// Spectral multidimensional scaling: distances between samples, smooth in eigenfunctions of the surface.
    Spectral {
        /// Eigenfunctions of the Laplace-Beltrami operator. The paper's comparisons take 300.
        eigenvectors: usize,
        /// Weight of the distances against smoothness on a surface of unit area, positive, perhaps infinite.
        mu: f64,
    },
    /// Fast multidimensional scaling: columns of distances, smooth on the surface beyond the samples.
    Fmds,
    /// Kernel PCA with the Nystrom method, the paper's baseline.
    KernelPca {
        /// Eigenpairs of the sample kernel to keep. Default: half the samples.
        rank: Option<usize>,
        /// Width of the kernel.
        bandwidth: Bandwidth,
    },
    /// SMACOF on all pairs from the result of NMDS: straight lines fit distances, not their squares.
    Smacof {
        /// Of the NMDS it starts from.
        regularization: Regularization,
        /// When it ends.
        descent: SmacofOptions,
    },
}

impl Default for EmbedMethod {
    fn default() -> Self {
        Self::Nystrom { regularization: Regularization::default() }
    }
}

impl EmbedMethod {
    /// NMDS with the low-rank regularisation of this rank.
    #[must_use]
    pub fn low_rank(rank: usize) -> Self {
        Self::Nystrom { regularization: Regularization::LowRank { rank: Some(rank) } }
    }

    /// Spectral scaling in 300 eigenfunctions, as in the paper, with the default weight of the distances.
    #[must_use]
    pub fn spectral() -> Self {
        Self::Spectral { eigenvectors: 300, mu: SpectralOptions::default().mu }
    }

    /// The name used on the command line and in records.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Nystrom { .. } => "nmds",
            Self::Classical => "mds",
            Self::Landmark => "landmark",
            Self::Spectral { .. } => "spectral",
            Self::Fmds => "fmds",
            Self::KernelPca { .. } => "kpca",
            Self::Smacof { .. } => "smacof",
        }
    }

    /// How the inverse of the sample matrix is regularised, by the methods that have one.
    #[must_use]
    pub fn regularization(&self) -> Option<Regularization> {
        match self {
            Self::Nystrom { regularization } | Self::Smacof { regularization, .. } => Some(*regularization),
            Self::Classical
            | Self::Landmark
            | Self::Spectral { .. }
            | Self::Fmds
            | Self::KernelPca { .. } => None,
        }
    }

    /// Whether coordinates are lengths that distances can be compared with; the components of a kernel
    /// are not.
    #[must_use]
    pub fn has_unit(&self) -> bool {
        !matches!(self, Self::KernelPca { .. })
    }
}

/// How the stress of an embedding is found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum StressChoice {
    /// Exactly up to 5,000 vertices, estimated beyond.
    #[default]
    Auto,
    /// From the distances between all pairs of vertices.
    Exact,
    /// From the distances of 100 vertices to all others.
    Estimate,
    /// Not at all.
    Skip,
}
