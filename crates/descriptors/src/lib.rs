//! Canonical forms, signatures, and the distance between two shapes.
//!
//! ```text
//! nmds::Embedding -> CanonicalForm -> rigid::PointSet
//! linalg::LandmarkDistances -> SampledForm, a form of many dimensions
//! CanonicalForm, SampledForm, linalg::LandmarkDistances, LaplaceSpectrum -> Signature -> ShapeMetric::fuse
//! fused vector, form, rigid signature -> PreparedShape -> ShapePair (alignments, each found once) -> ShapeDistance
//! ```
//!
//! Knows nothing of files or indexes.

mod boundary;
mod calibration;
mod canonical_form;
mod error;
mod features;
mod metric;
mod partial;
mod sampled_form;
mod shape_pair;
mod signature;
mod spectrum;

pub use boundary::{Boundary, Sample};
pub use canonical_form::{CanonicalForm, Normalization};
pub use error::DescriptorError;
pub use metric::{ShapeDistance, ShapeMetric};
pub use partial::{DiscAreas, PartDiscAreas, PartDistance};
pub use sampled_form::SampledForm;
pub use shape_pair::{PreparedShape, ShapePair, Side};
pub use signature::{
    Signature, SignatureKind, geodesic_spectrum, heat_kernel_signature, rigid_signature, shape_dna,
    wave_kernel_signature, wave_kernels,
};
pub use spectrum::LaplaceSpectrum;
