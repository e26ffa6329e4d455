//! Signatures: short lists of numbers that describe a surface and are compared by Euclidean distance.
//!
//! All of them
//!
//! * describe the surface scaled to unit area, so scale does not count;
//! * depend on distances along the surface only, so bending, rigid motions, mirror images and the order of vertices
//!   change nothing but rounding; bending changes the rigid signature, which only surfaces have that do not bend;
//! * weight points by the area around them, so another triangulation changes them as little as it changes the
//!   surface;
//! * have a fixed length and no NaN.

mod geodesic_spectrum;
mod kind;
mod quantiles;
mod rigid;
mod spectral;

pub use geodesic_spectrum::geodesic_spectrum;
pub(crate) use geodesic_spectrum::log_magnitudes;
pub use kind::{Signature, SignatureKind};
pub use rigid::rigid_signature;
pub use spectral::{heat_kernel_signature, shape_dna, wave_kernel_signature, wave_kernels};
