//! Signatures: short lists of numbers that describe a surface and are compared by Euclidean distance.
//!
//! All of them
//!
//! * describe the surface scaled to unit area, so scale does not count;
//! * depend on distances along the surface only, so bending, rigid motions, mirror images and the order of vertices
//!   change nothing but rounding;
//! * weight points by the area around them, so another triangulation changes them as little as it changes the
//!   surface;
//! * have a fixed length and no NaN.

mod geodesic_spectrum;
mod kernels;
mod moments;
mod quantiles;
mod shape_distribution;
mod shape_dna;

use std::str::FromStr;

pub use geodesic_spectrum::geodesic_spectrum;
pub use kernels::{heat_kernel_signature, wave_kernel_signature};
pub use moments::moment_signature;
pub use shape_distribution::d2_histogram;
pub use shape_dna::shape_dna;

use serde::{Deserialize, Serialize};

use crate::DescriptorError;

/// The kinds of signatures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SignatureKind {
    /// [`moment_signature`]
    Moments,
    /// [`d2_histogram`]
    D2,
    /// [`geodesic_spectrum`]
    GeodesicSpectrum,
    /// [`shape_dna`]
    ShapeDna,
    /// [`heat_kernel_signature`]
    HeatKernel,
    /// [`wave_kernel_signature`]
    WaveKernel,
}

impl SignatureKind {
    /// All kinds, in the order of a fused vector.
    pub const ALL: [Self; 6] =
        [Self::Moments, Self::D2, Self::GeodesicSpectrum, Self::ShapeDna, Self::HeatKernel, Self::WaveKernel];

    /// The name used on the command line and in records.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Moments => "moments",
            Self::D2 => "d2",
            Self::GeodesicSpectrum => "geodesic-spectrum",
            Self::ShapeDna => "shape-dna",
            Self::HeatKernel => "heat-kernel",
            Self::WaveKernel => "wave-kernel",
        }
    }

    /// Number of values, without the size.
    #[must_use]
    pub const fn n_values(self) -> usize {
        match self {
            Self::Moments => moments::LENGTH,
            Self::D2 => shape_distribution::BINS,
            Self::GeodesicSpectrum => geodesic_spectrum::LENGTH,
            Self::ShapeDna => shape_dna::LENGTH,
            Self::HeatKernel => kernels::HEAT_LENGTH,
            Self::WaveKernel => kernels::WAVE_LENGTH,
        }
    }
}

impl FromStr for SignatureKind {
    type Err = DescriptorError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL.into_iter().find(|kind| kind.name() == name).ok_or_else(|| {
            DescriptorError::UnknownSignature {
                name: name.to_owned(),
                known: Self::ALL.map(Self::name).join(", "),
            }
        })
    }
}

/// A list of numbers that describes a surface; the distance between two of a kind is Euclidean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signature {
    /// The kind of signature.
    pub kind: SignatureKind,
    /// [`SignatureKind::n_values`] numbers, and one more with the size.
    pub values: Vec<f64>,
}

impl Signature {
    /// Euclidean distance to another signature; infinite unless both are of one kind and length.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        if self.kind != other.kind || self.values.len() != other.values.len() {
            return f64::INFINITY;
        }
        self.values.iter().zip(&other.values).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
    }
}
