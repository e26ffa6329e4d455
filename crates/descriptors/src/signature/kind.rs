//! Kinds of signatures, and their values.

use serde::{Deserialize, Serialize};

/// The kinds of signatures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SignatureKind {
    /// [`SampledForm::spectrum`](crate::SampledForm::spectrum).
    FormSpectrum,
    /// [`geodesic_spectrum`](crate::geodesic_spectrum).
    GeodesicSpectrum,
    /// [`shape_dna`](crate::shape_dna).
    ShapeDna,
    /// [`heat_kernel_signature`](crate::heat_kernel_signature).
    HeatKernel,
    /// [`wave_kernel_signature`](crate::wave_kernel_signature).
    WaveKernel,
    /// [`rigid_signature`](crate::rigid_signature).
    Rigid,
}

/// Name and number of values of every kind.
const TABLE: [(&str, usize); SignatureKind::ALL.len()] = [
    ("form-spectrum", 24),
    ("geodesic-spectrum", 24),
    ("shape-dna", 20),
    ("heat-kernel", 32),
    ("wave-kernel", 96),
    ("rigid", 27),
];

impl SignatureKind {
    /// All kinds, in the order of descriptions. Every surface has all but the last.
    pub const ALL: [Self; 6] = [
        Self::FormSpectrum,
        Self::GeodesicSpectrum,
        Self::ShapeDna,
        Self::HeatKernel,
        Self::WaveKernel,
        Self::Rigid,
    ];

    /// The kinds that every surface has.
    pub const INTRINSIC: [Self; 5] =
        [Self::FormSpectrum, Self::GeodesicSpectrum, Self::ShapeDna, Self::HeatKernel, Self::WaveKernel];

    /// The name used on the command line and in records.
    pub const fn name(self) -> &'static str {
        TABLE[self as usize].0
    }

    /// Number of values.
    pub const fn n_values(self) -> usize {
        TABLE[self as usize].1
    }
}

/// A list of numbers that describes a surface; the distance between two of a kind is Euclidean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signature {
    /// The kind of signature.
    pub kind: SignatureKind,
    /// [`SignatureKind::n_values`] numbers.
    pub values: Vec<f64>,
}

impl Signature {
    /// Euclidean distance to another signature; infinite unless both are of one kind and length.
    pub fn distance(&self, other: &Self) -> f64 {
        if self.kind != other.kind || self.values.len() != other.values.len() {
            return f64::INFINITY;
        }
        self.values.iter().zip(&other.values).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
    }
}
