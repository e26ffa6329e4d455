//! One vector of all signatures.

use super::{Signature, SignatureKind};

/// Sizes that differ by this factor are as far apart as two poses of one body.
const SAME_SIZE: f64 = 1.05;

/// Values of a fused signature of all kinds, without that of the size.
pub const FUSED_SIZE: usize = {
    let mut sum = 0;
    let mut i = 0;
    while i < SignatureKind::ALL.len() {
        sum += SignatureKind::ALL[i].n_values();
        i += 1;
    }
    sum
};

/// See [`SignatureKind::unit`].
pub(super) fn unit(kind: SignatureKind) -> f64 {
    match kind {
        SignatureKind::Moments => 0.114,
        SignatureKind::D2 => 0.068,
        SignatureKind::GeodesicSpectrum => 0.0258,
        SignatureKind::ShapeDna => 0.0842,
        SignatureKind::HeatKernel => 0.192,
        SignatureKind::WaveKernel => 0.257,
    }
}

/// See [`SignatureKind::weight`].
pub(super) fn weight(kind: SignatureKind) -> f64 {
    match kind {
        SignatureKind::Moments => 0.018,
        SignatureKind::D2 => 0.019,
        SignatureKind::GeodesicSpectrum => 0.03,
        SignatureKind::ShapeDna => 0.25,
        SignatureKind::HeatKernel => 0.206,
        SignatureKind::WaveKernel => 0.477,
    }
}

/// The size of a surface as a number whose differences are distances: `ln √area` in units of 5 %, by which poses
/// and scans of one body may well differ.
///
/// The area is in squared units of the mesh; those of two surfaces must be of one unit.
#[must_use]
pub fn size_coordinate(area: f64) -> f64 {
    0.5 * area.max(f64::MIN_POSITIVE).ln() / SAME_SIZE.ln()
}

/// All signatures as one vector, in their order: the squared Euclidean distance of two such vectors is
/// `Σ_k w_k (d_k / u_k)²` with `d_k` the distances of the parts, `u_k` their [units](SignatureKind::unit) and
/// `w_k` their [weights](SignatureKind::weight). With an `area` size counts as one part more, of weight one, in which
/// 5 % are a unit.
///
/// Two poses of one body are about one apart. Units and weights were found on the built-in families and on
/// nothing else. Values are rounded to 32 bits: half the memory to scan, and an error far below the noise.
#[must_use]
pub fn fuse(signatures: &[Signature], area: Option<f64>) -> Vec<f32> {
    let parts = signatures.iter().flat_map(|signature| {
        let factor = signature.kind.weight().sqrt() / signature.kind.unit();
        signature.values.iter().map(move |value| (value * factor) as f32)
    });
    parts.chain(area.map(|area| size_coordinate(area) as f32)).collect()
}
