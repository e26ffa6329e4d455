//! Canonical forms, their rigid alignment, and distances between aligned forms.
//!
//! `nmds::Embedding` -> **[`CanonicalForm`] -> [`PreparedForm`] -> [`match_forms`]** -> `retrieval`
//!
//! `surface::IntrinsicMesh` -> **[`LaplaceSpectrum`]** -> `nmds` (spectral embeddings)
//!
//! forms, distances, spectra -> **[`Signature`] -> [`fuse`]** -> `retrieval`
//!
//! Knows nothing of files or indexes.

mod alignment;
mod bound;
mod canonical_form;
mod error;
mod matching;
mod prepared;
mod signature;
mod spectrum;
mod spread;

pub use alignment::Alignment;
pub use canonical_form::{CanonicalForm, Normalization};
pub use error::DescriptorError;
pub use matching::{FormDistance, FormMatch, MatchOptions, Reflections, match_forms, match_forms_within};
pub use prepared::PreparedForm;
pub use signature::{
    FUSED_SIZE, Signature, SignatureKind, d2_histogram, fuse, geodesic_spectrum, heat_kernel_signature,
    moment_signature, shape_dna, size_coordinate, wave_kernel_signature,
};
pub use spectrum::LaplaceSpectrum;
