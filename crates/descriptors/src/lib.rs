//! Canonical forms, their rigid alignment, and distances between aligned forms.
//!
//! `nmds::Embedding` -> **[`CanonicalForm`] -> [`PreparedForm`] -> [`match_forms`]** -> `retrieval`
//!
//! `mesh::IntrinsicMesh` -> **[`LaplaceSpectrum`]** -> `nmds` (spectral embeddings)
//!
//! Knows nothing of files or indexes.

mod alignment;
mod canonical_form;
mod error;
mod matching;
mod prepared;
mod spectrum;

pub use alignment::Alignment;
pub use canonical_form::{CanonicalForm, Normalization};
pub use error::DescriptorError;
pub use matching::{FormDistance, FormMatch, MatchOptions, Reflections, match_forms};
pub use prepared::PreparedForm;
pub use spectrum::LaplaceSpectrum;
