//! Embedding methods: one entry here makes a method available to every program.

use descriptors::LaplaceSpectrum;
use linalg::{DistanceMatrix, LandmarkDistances};
use nmds::{
    Bandwidth, Embedding, KernelPcaOptions, LandmarkPairs, NystromOptions, Regularization, SampleSearch,
    SmacofOptions, SmacofReport, SpectralBasis, SpectralOptions, classical, kernel_pca, landmark_mds,
    nystrom, smacof, spectral,
};
use serde::{Deserialize, Serialize};
use surface::IntrinsicMesh;

use super::as_text;
use super::distances::{EmbedByRank, Measurement, Sampled};
use super::plan::check_memory;
use crate::error::Error;

/// How distances become coordinates.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EmbedMethod {
    /// Nystrom multidimensional scaling, the paper's method.
    #[serde(rename = "nmds")]
    Nystrom {
        /// How the inverse of the sample matrix is regularised. Default: low rank, half the samples.
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
    KernelPca {
        /// Eigenpairs of the sample kernel to keep. Default: half the samples.
        rank: Option<usize>,
        /// Width of the kernel.
        bandwidth: Bandwidth,
    },
    /// Classical multidimensional scaling of all pairs: the optimum, at quadratic cost.
    #[serde(rename = "mds")]
    Classical,
    /// SMACOF on all pairs, started from the result of NMDS: fits distances instead of squared distances.
    Smacof {
        /// Regularisation of the NMDS it starts from.
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

    /// The method with this [name](Self::name) and default options.
    pub fn named(name: &str) -> Option<Self> {
        Self::all().into_iter().find(|method| method.name() == name)
    }

    /// The name on the command line and in records.
    pub fn name(&self) -> &'static str {
        self.entry().0
    }

    /// What the method computes, in one line.
    pub fn summary(&self) -> &'static str {
        self.entry().1
    }

    fn entry(&self) -> (&'static str, &'static str) {
        match self {
            Self::Nystrom { .. } => ("nmds", "Nystrom multidimensional scaling"),
            Self::Landmark => {
                ("landmark", "Landmark MDS: embed the samples, place the rest by their distances to them")
            }
            Self::Spectral { .. } => {
                ("spectral", "Spectral scaling: distances between samples, in eigenfunctions of the surface")
            }
            Self::KernelPca { .. } => ("kpca", "Kernel PCA with the Nystrom method"),
            Self::Classical => ("mds", "Classical multidimensional scaling of all pairs"),
            Self::Smacof { .. } => ("smacof", "SMACOF on all pairs, started from the result of nmds"),
        }
    }

    /// NMDS with the low-rank regularisation of this rank.
    pub fn low_rank(rank: usize) -> Self {
        Self::Nystrom { regularization: Regularization::LowRank { rank: Some(rank) } }
    }

    /// Spectral scaling in 300 eigenfunctions, as in the paper, with the default weight of the distances.
    pub fn spectral() -> Self {
        Self::Spectral { eigenvectors: 300, mu: SpectralOptions::default().mu }
    }

    /// The regularisation of the sample matrix, for methods that have one.
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
        measurement: &mut Measurement<'_>,
    ) -> Result<Outcome, Error> {
        let budget = measurement.budget.clone();
        let sampled = |(embedding, distances)| Outcome { embedding, distances, all: None, descent: None };
        let surface = || surface.unwrap_or_else(|| unreachable!("{} needs the surface", self.name()));
        Ok(match *self {
            Self::Nystrom { regularization } => sampled(by_nystrom(regularization, dim, measurement)?),
            Self::Landmark => sampled(measurement.sampled(&of_one_rank(dim, &|d, _| landmark_mds(d, dim)))?),
            Self::Spectral { eigenvectors, mu } => {
                let surface = surface();
                let p = surface.n_vertices();
                check_memory(p, eigenvectors.min(p), &budget)?;
                let LaplaceSpectrum { values, vectors, masses, .. } =
                    LaplaceSpectrum::new(surface, eigenvectors, &budget)?;
                let basis = SpectralBasis { values: &values, vectors: &vectors, masses: &masses };
                let embed = |d: &_, _| spectral(d, &basis, &SpectralOptions { mu, dim });
                sampled(measurement.sampled(&of_one_rank(dim, &embed))?)
            }
            Self::KernelPca { rank, bandwidth } => {
                let embed = |d: &_, _| kernel_pca(d, &KernelPcaOptions { bandwidth, rank, dim });
                sampled(measurement.sampled(&of_one_rank(dim, &embed))?)
            }
            Self::Classical => {
                let all = measurement.all_pairs()?;
                let embedding = classical(&all, dim, &budget)?;
                let distances = measurement.columns_of(&all)?;
                Outcome { embedding, distances, all: Some(all), descent: None }
            }
            Self::Smacof { regularization, descent } => {
                let (start, distances) = by_nystrom(regularization, dim, measurement)?;
                let all = measurement.all_pairs()?;
                let (landmarks, masses): (Vec<usize>, Vec<f64>) =
                    (0..all.n_points()).map(|i| (i, 1.0)).unzip();
                let pairs = LandmarkPairs { landmarks: &landmarks, rows: &all, masses: &masses, power: 0.0 };
                let (embedding, report) = smacof(&start.coords, &pairs, &descent, &budget)?;
                let embedding = Embedding { rank: start.rank, ..embedding };
                Outcome { embedding, distances, all: Some(all), descent: Some(report) }
            }
        })
    }
}

/// A method without a rank, or with one that its options fix.
fn of_one_rank<'a>(dim: usize, embed: &'a EmbedByRank<'a>) -> Sampled<'a> {
    Sampled { embed, other_ranks: &|_| Vec::new(), first_samples: SampleSearch::first(dim) }
}

/// NMDS, with the best rank if the number of samples is searched for and no rank is given.
fn by_nystrom(
    regularization: Regularization,
    dim: usize,
    measurement: &mut Measurement<'_>,
) -> Result<(Embedding, LandmarkDistances), Error> {
    let options = NystromOptions { regularization, dim };
    let with = |rank: Option<usize>| match rank {
        None => options.clone(),
        rank => NystromOptions { regularization: Regularization::LowRank { rank }, dim },
    };
    let embed = |distances: &LandmarkDistances, rank| nystrom(distances, &with(rank));
    let (other_ranks, first_samples) = (&|n| options.other_ranks(n), options.first_samples());
    measurement.sampled(&Sampled { embed: &embed, other_ranks, first_samples })
}

/// The result of a method.
pub(super) struct Outcome {
    pub(super) embedding: Embedding,
    /// Distances from the samples to all vertices; from as many of them for a method without samples.
    pub(super) distances: LandmarkDistances,
    /// Distances between all vertices, if the method has measured them.
    pub(super) all: Option<DistanceMatrix>,
    pub(super) descent: Option<SmacofReport>,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_known_by_their_names_in_options_too() {
        for method in EmbedMethod::all() {
            assert_eq!(EmbedMethod::named(method.name()).as_ref(), Some(&method));
            let text = serde_json::to_string(&method).unwrap();
            assert!(text.contains(&format!("\"{}\"", method.name())), "{text}");
        }
        assert_eq!(EmbedMethod::named("umap"), None);
    }
}
