//! Embedding methods: one entry here makes a method available to every program.

use descriptors::LaplaceSpectrum;
use nmds::{
    Bandwidth, EmbedSamples, Embedding, LandmarkPairs, Regularization, SampleSearch, SmacofOptions,
    SpectralBasis, classical, kernel_pca, landmark_mds, nystrom, smacof, spectral,
};
use serde::{Deserialize, Serialize};
use surface::IntrinsicMesh;

use super::as_text;
use super::distances::Measurement;
use super::outcome::Outcome;
use super::plan::check_memory;
use crate::error::Error;

/// Eigenfunctions of spectral scaling, as in the comparisons of the paper.
pub(super) const EIGENVECTORS: usize = 300;

/// How distances become coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, strum::IntoStaticStr)]
#[serde(rename_all = "kebab-case")]
#[strum(serialize_all = "kebab-case")]
pub enum EmbedMethod {
    /// Nystrom multidimensional scaling, the paper's method.
    #[serde(rename = "nmds")]
    #[strum(serialize = "nmds")]
    Nystrom {
        /// How the inverse of the sample matrix is regularized. Default: low rank, half the samples.
        regularization: Regularization,
    },
    /// Landmark MDS: classical scaling of the samples; the other vertices are placed by their distances to them.
    Landmark,
    /// Spectral multidimensional scaling: distances between samples, smooth in eigenfunctions of the surface.
    Spectral {
        /// Number of eigenfunctions of the Laplace-Beltrami operator. The paper's comparisons take 300.
        eigenvectors: usize,
        /// Weight of the distances against smoothness on a surface of unit area: positive, may be infinite.
        #[serde(with = "as_text")]
        mu: f64,
    },
    /// Kernel PCA with the Nystrom method, the paper's baseline.
    #[serde(rename = "kpca")]
    #[strum(serialize = "kpca")]
    KernelPca {
        /// Eigenpairs of the sample kernel to keep. Default: half the samples.
        rank: Option<usize>,
        /// Width of the kernel.
        bandwidth: Bandwidth,
    },
    /// Classical multidimensional scaling of all pairs: the optimum, at quadratic cost.
    #[serde(rename = "mds")]
    #[strum(serialize = "mds")]
    Classical,
    /// SMACOF on all pairs, started from the result of NMDS: fits distances instead of squared distances.
    Smacof {
        /// Regularization of the NMDS it starts from.
        regularization: Regularization,
        /// When it stops.
        descent: SmacofOptions,
    },
}

impl Default for EmbedMethod {
    fn default() -> Self {
        Self::Nystrom { regularization: Regularization::default() }
    }
}

impl EmbedMethod {
    /// Every method, each with its default options.
    pub fn all() -> [Self; 6] {
        let regularization = Regularization::default();
        [
            Self::Nystrom { regularization },
            Self::Landmark,
            Self::spectral(),
            Self::KernelPca { rank: None, bandwidth: Bandwidth::default() },
            Self::Classical,
            Self::Smacof { regularization, descent: SmacofOptions::default() },
        ]
    }

    /// The name on the command line and in records.
    pub fn name(&self) -> &'static str {
        self.into()
    }

    /// NMDS with the low-rank regularization of this rank.
    pub fn low_rank(rank: usize) -> Self {
        Self::Nystrom { regularization: Regularization::LowRank { rank: Some(rank) } }
    }

    /// Spectral scaling in 300 eigenfunctions, as in the paper, with the default weight of the distances.
    pub fn spectral() -> Self {
        Self::Spectral { eigenvectors: EIGENVECTORS, mu: SpectralBasis::MU }
    }

    /// The regularization of the sample matrix, for methods that have one.
    pub fn regularization(&self) -> Option<Regularization> {
        match self {
            Self::Nystrom { regularization } | Self::Smacof { regularization, .. } => Some(*regularization),
            _ => None,
        }
    }

    /// Whether coordinates are lengths. The components of a kernel are not, so distances cannot be compared
    /// with them.
    pub fn has_unit(&self) -> bool {
        !matches!(self, Self::KernelPca { .. })
    }

    /// Whether the method works on distances from samples, rather than between all pairs of vertices.
    pub fn is_sampled(&self) -> bool {
        !matches!(self, Self::Classical)
    }

    /// Whether the method reads distances from samples in blocks, so that they need not fit into memory.
    pub(super) fn streams(&self) -> bool {
        matches!(self, Self::Nystrom { .. } | Self::Landmark)
    }

    /// Whether the method needs the surface besides distances.
    pub(super) fn needs_surface(&self) -> bool {
        matches!(self, Self::Spectral { .. })
    }

    /// Measures the distances that the method needs and embeds in `dim` dimensions.
    ///
    /// # Panics
    /// If the method [needs the surface](Self::needs_surface) and there is none.
    pub(super) fn run(
        &self,
        surface: Option<&IntrinsicMesh>,
        dim: usize,
        measurement: &Measurement<'_>,
    ) -> Result<Outcome, Error> {
        let budget = measurement.observer.budget();
        let by_nystrom = |regularization| {
            let first = Regularization::first_samples(regularization, dim);
            measurement.sampled(first, &|distances| nystrom(distances, regularization, dim))
        };
        let sampled = |embed: &EmbedSamples<'_>| measurement.sampled(SampleSearch::first(dim), embed);
        let surface = || surface.unwrap_or_else(|| unreachable!("{} needs the surface", self.name()));
        match *self {
            Self::Nystrom { regularization } => by_nystrom(regularization),
            Self::Landmark => sampled(&|distances| landmark_mds(distances, dim)),
            Self::Spectral { eigenvectors, mu } => {
                let surface = surface();
                let p = surface.n_vertices();
                check_memory(p, eigenvectors.min(p), &budget)?;
                let LaplaceSpectrum { values, vectors, masses, .. } =
                    LaplaceSpectrum::new(surface, eigenvectors, &budget)?;
                let basis = SpectralBasis { values: &values, vectors: &vectors, masses: &masses };
                sampled(&|distances| spectral(distances, &basis, mu, dim))
            }
            Self::KernelPca { rank, bandwidth } => {
                sampled(&|distances| kernel_pca(distances, bandwidth, rank, dim))
            }
            Self::Classical => {
                let all = measurement.all_pairs()?;
                let embedding = classical(&all, dim, &budget)?;
                let distances = measurement.sample_distances()?;
                Ok(Outcome { embedding, distances, search: None, all: Some(all), descent: None })
            }
            Self::Smacof { regularization, descent } => {
                let start = by_nystrom(regularization)?;
                let all = measurement.all_pairs()?;
                let (landmarks, masses): (Vec<usize>, Vec<f64>) =
                    (0..all.n_points()).map(|i| (i, 1.0)).unzip();
                let pairs = LandmarkPairs { landmarks: &landmarks, rows: &all, masses: &masses, power: 0.0 };
                let (embedding, report) = smacof(&start.embedding.coords, &pairs, &descent, &budget)?;
                let embedding = Embedding { rank: start.embedding.rank, ..embedding };
                Ok(Outcome { embedding, all: Some(all), descent: Some(report), ..start })
            }
        }
    }
}
