//! Canonical forms, their alignment, signatures, and the distance between two shapes.
//!
//! ```text
//! nmds::Embedding -> CanonicalForm -> PreparedForm -> match_forms -> FormMatch
//! CanonicalForm, linalg::LandmarkDistances, LaplaceSpectrum -> Signature -> ShapeMetric::fuse
//! fused vector, form -> PreparedShape -> ShapePair (alignments, each found once) -> ShapeMetric (distance, verdict)
//! ```
//!
//! Knows nothing of files or indexes.

mod alignment;
mod boundary;
mod canonical_form;
mod correspondence;
mod error;
mod handedness;
mod matching;
mod metric;
mod nearest;
mod outward;
mod partial;
mod prepared;
mod shape_pair;
mod signature;
mod spectrum;
mod spread;
mod verdict;

pub use alignment::Alignment;
pub use boundary::Boundary;
pub use canonical_form::{CanonicalForm, Normalization};
pub use correspondence::{MapKind, MatchOptions, MatchShape, SurfaceMap, match_surfaces};
pub use error::DescriptorError;
pub use handedness::handedness;
pub use matching::{FormMatch, Reflections, match_forms, match_forms_within};
pub use metric::{FormDistance, Handedness, MatchKind, ShapeDistance, ShapeMetric};
pub use nearest::NearestPoints;
pub use partial::{DiscAreas, PartDiscAreas, PartDistance};
pub use prepared::PreparedForm;
pub use shape_pair::{PreparedShape, ShapePair};
pub use signature::{
    Signature, SignatureKind, d2_histogram, geodesic_spectrum, heat_kernel_signature, moment_signature,
    shape_dna, wave_kernel_signature,
};
pub use spectrum::LaplaceSpectrum;
pub use verdict::{Verdict, VerdictKind};
