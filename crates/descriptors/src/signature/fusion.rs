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
        SignatureKind::Moments => 0.1,
        SignatureKind::D2 => 0.07,
        SignatureKind::GeodesicSpectrum => 0.026,
        SignatureKind::ShapeDna => 0.08,
        SignatureKind::HeatKernel => 0.15,
        SignatureKind::WaveKernel => 0.18,
    }
}

/// `ln √area` in units of what counts as the same size.
pub(super) fn size(area: f64) -> f64 {
    0.5 * area.max(f64::MIN_POSITIVE).ln() / SAME_SIZE.ln()
}

/// All signatures as one vector, in their order: the squared Euclidean distance of two such vectors is
/// `Σ_k (d_k / u_k)²` with `d_k` the distances of the parts and `u_k` their [units](SignatureKind::unit); with an `area`
/// size counts as one part more.
///
/// Every part is measured against what poses and triangulations do to it, found on the built-in families: a part
/// with little noise counts more, one that tells nothing apart hardly at all. No weight was chosen by looking
/// at scores. Values are rounded to 32 bits: half the memory to scan, and an error far below the noise.
#[must_use]
pub fn fuse(signatures: &[Signature], area: Option<f64>) -> Vec<f32> {
    let parts = signatures.iter().flat_map(|signature| {
        let unit = signature.kind.unit();
        signature.values.iter().map(move |value| (value / unit) as f32)
    });
    parts.chain(area.map(|area| size(area) as f32)).collect()
}
