//! Multidimensional scaling: coordinates of points whose Euclidean distances approximate given distances.
//!
//! `linalg::LandmarkDistances` -> **[`nystrom`]** and others -> [`Embedding`] -> `descriptors`
//!
//! NMDS stands for Nystrom (not nonmetric) multidimensional scaling. Knows nothing of meshes or of how distances were
//! measured.
//!
//! | function | embeds from | reference |
//! |---|---|---|
//! | [`nystrom`] | distances from n samples to all p points | Shamai, Aflalo, Zibulevsky and Kimmel 2015 |
//! | [`landmark_mds`] | the same | de Silva and Tenenbaum 2002 |
//! | [`kernel_pca`] | the same | Liu, Jain and Zhang 2006 |
//! | [`spectral`] | distances between n samples, and eigenpairs of a Laplacian | Aflalo and Kimmel 2013 |
//! | [`classical`], [`classical_full`] | all p x p distances | Torgerson 1952 |
//! | [`OutOfSample`] | distances from further points to the n samples of [`nystrom`] | Bengio et al. 2003 |
//! | [`smacof`] | distances from n samples to all p points, or all p x p distances, and a start | de Leeuw 1977; Sammon 1969 |
//!
//! [`SampleSearch`] finds how many samples are enough.
//! [`low_rank_factor`] approximates all pairs of squared distances from the same n columns instead of embedding them.

mod classical;
mod embedding;
mod error;
mod kernel_pca;
mod landmark;
mod nystrom;
mod out_of_sample;
mod passes;
mod reconstruction;
mod regularization;
mod row_sample;
mod sample_search;
mod smacof;
mod spectral;
mod squares;
mod stress;

pub use classical::{classical, classical_full};
pub use embedding::Embedding;
pub use error::NmdsError;
pub use kernel_pca::{Bandwidth, kernel_pca};
pub use landmark::landmark_mds;
pub use nystrom::{nystrom, nystrom_extended};
pub use out_of_sample::OutOfSample;
pub use reconstruction::{Reconstruction, ReconstructionError, low_rank_factor, sample_eigenvalues};
pub use regularization::{Regularization, RpiAlpha, largest_magnitudes};
pub use row_sample::{RowSample, sample_rows};
pub use sample_search::{EmbedSamples, SampleSearch, SampleStop, SampleTrial, SamplesReport};
pub use smacof::{LandmarkPairs, SmacofOptions, SmacofReport, SmacofStop, smacof};
pub use spectral::{SpectralBasis, spectral};
pub use stress::{DistanceRows, Stress, estimate_stress, paper_stress, stress};
