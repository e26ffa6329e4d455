//! Signatures: a surface as a short list of numbers that Euclidean distance compares.
//!
//! [`CanonicalForm`](crate::CanonicalForm), `linalg::LandmarkDistances`,
//! [`LaplaceSpectrum`](crate::LaplaceSpectrum) -> **[`Signature`]** -> [`fuse`] -> `retrieval`
//!
//! What all of them have in common:
//!
//! * They belong to the surface scaled to unit area, so scale does not count;
//!   [`Signature::with_size`] makes it count.
//! * They see distances on the surface alone: bending, rigid motions and mirror images change nothing but
//!   rounding, and an order of vertices there is not.
//! * Points count by the area around them, so another triangulation changes them as little as it changes
//!   the surface.
//! * They are always of the same length and never hold a NaN.

mod fusion;
mod geodesic_spectrum;
mod kernels;
mod moments;
mod quantiles;
mod shape_distribution;
mod shape_dna;

use std::str::FromStr;

pub use fusion::{FUSED_SIZE, fuse, size_coordinate};
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
    /// All kinds, in the order of a fused signature.
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

    /// Number of values, without that of the size.
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

    /// Root mean square of the distances between two poses of one body, triangulated each on its own: what
    /// a distance has to be measured against.
    ///
    /// Found on the built-in articulated families, in meshes of 1,500 to 8,000 vertices;
    /// `cargo run --release -p experiments -- units` measures it again.
    #[must_use]
    pub fn unit(self) -> f64 {
        fusion::unit(self)
    }

    /// How much the kind counts beside the others, all weights summing to one: the product of its separation and the
    /// number of its components, over the sum of all products.
    ///
    /// The separation is the mean squared distance between two of the built-in families over that between two poses of
    /// one, as in Fisher's discriminant. The components are `tr(C)² / tr(C²)` with `C` the covariance of
    /// the values within families: in so many independent ways poses move a signature, and were they whitened,
    /// squared distances would grow with them. Found as the [unit](Self::unit).
    #[must_use]
    pub fn weight(self) -> f64 {
        fusion::weight(self)
    }
}

impl FromStr for SignatureKind {
    type Err = DescriptorError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        Self::ALL
            .into_iter()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| DescriptorError::UnknownSignature { name: name.to_owned() })
    }
}

/// A surface as a list of numbers; the distance of two is Euclidean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signature {
    /// What the numbers are.
    pub kind: SignatureKind,
    /// The numbers, [`SignatureKind::n_values`] of them and one more with the size.
    pub values: Vec<f64>,
}

impl Signature {
    /// The same with the size of the surface, one value more: its [coordinate](size_coordinate) times the kind's
    /// [unit](SignatureKind::unit), so that sizes that differ by 5 % are as far apart as two poses of one body.
    #[must_use]
    pub fn with_size(mut self, area: f64) -> Self {
        self.values.push(self.kind.unit() * size_coordinate(area));
        self
    }

    /// Euclidean distance to a signature of the same kind and length; infinite when it is none.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        if self.kind != other.kind || self.values.len() != other.values.len() {
            return f64::INFINITY;
        }
        self.values.iter().zip(&other.values).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
    }
}
