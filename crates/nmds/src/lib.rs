//! Embeddings of points from distances: straight lines in the result equal given distances.
//!
//! `linalg::LandmarkDistances` -> **nmds** -> [`Embedding`] -> `descriptors`
//!
//! NMDS is Nystrom multidimensional scaling throughout, never the nonmetric kind. Knows nothing of
//! meshes or of where distances come from.

mod classical;
mod embedding;
mod error;
mod fmds;
mod kernel_pca;
mod landmark;
mod nystrom;
mod reconstruction;
mod regularization;
mod smacof;
mod spectral;
mod stress;
#[cfg(test)]
mod testing;

pub use classical::{classical, classical_full};
pub use embedding::Embedding;
pub use error::NmdsError;
pub use fmds::fmds;
pub use kernel_pca::{Bandwidth, KernelPcaOptions, kernel_pca};
pub use landmark::landmark_mds;
pub use nystrom::{NystromOptions, nystrom};
pub use reconstruction::{Reconstruction, ReconstructionError, sample_eigenvalues};
pub use regularization::{Regularization, RpiAlpha};
pub use smacof::{SmacofOptions, SmacofReport, SmacofStop, smacof};
pub use spectral::{SpectralBasis, SpectralOptions, spectral};
pub use stress::{
    DistanceRows, StressEstimate, estimate_paper_stress, normalized_stress, paper_stress, sample_rows,
};
