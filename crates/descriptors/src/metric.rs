//! The distance between two shapes. Everything that was calibrated for it is here.

use serde::{Deserialize, Serialize};

use crate::boundary::Boundary;
use crate::calibration;
use crate::signature::{Signature, SignatureKind};

/// Two values of fused vectors that differ by more standard deviations between poses count less, see
/// [`ShapeMetric::robust`].
///
/// Chosen on bodies of the built-in families, each a class of its own, and on the same with two distant points welded in
/// the query: see `docs/decisions/014-metric.md`.
const OUTLYING: f64 = 4.0;

/// The distance between two shapes, and the probability that they are one shape.
///
/// | symbol | meaning |
/// |---|---|
/// | `d_k`, `u_k`, `w_k` | distance of the signatures of kind `k`, its [unit](Self::unit) and [weight](Self::weight) |
/// | `s` | difference of the [size coordinates](Self::size_coordinate), where size counts |
/// | `f`, `u_f`, `w_f` | root mean square distance of the aligned forms of unit area, its unit and weight |
///
/// The *fused* distance is `√(Σ_k w_k (d_k / u_k)² + s²)`, the Euclidean distance of two [fused](Self::fuse) vectors. The
/// *robust* distance is the same with [Huber's](Self::robust) loss of every value, so that a few values that a weld or a
/// hole changes count less; it is never larger, but for the [rigid part](Self::rigid) between two surfaces that do not bend.
/// The *combined* distance is `√(robust² + w_f (f / u_f)²)`. Two poses of one body are about one apart by each.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ShapeMetric;

/// How far apart two shapes are, regardless of size.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct ShapeDistance {
    /// By signatures alone.
    #[serde(rename = "fused_distance")]
    pub fused: f64,
    /// By signatures and aligned forms.
    #[serde(rename = "combined_distance")]
    pub combined: f64,
}

impl ShapeDistance {
    /// Probability that both are one shape: that of one class, times that of one shape among those of one class.
    pub fn same_shape(&self) -> f64 {
        ShapeMetric::SAME_SHAPE.probability(self.combined) * self.same_class()
    }

    /// Probability that both are of one class.
    pub fn same_class(&self) -> f64 {
        ShapeMetric::SAME_CLASS.probability(self.combined)
    }

    /// Whether the shapes are more likely one shape than not. No distance makes that certain.
    pub fn is_same_shape(&self) -> bool {
        self.same_shape() > 0.5
    }

    /// Whether the shapes are certainly of different classes.
    pub fn is_different(&self) -> bool {
        self.combined > ShapeMetric::SAME_CLASS.gap()[1]
    }
}

impl ShapeMetric {
    /// Version of the calibration and of the signatures. Fused vectors of different versions cannot be compared.
    pub const VERSION: u32 = 6;

    /// The boundary between two poses of one body and two bodies of one class, both being equally frequent: a logistic
    /// regression on the logarithm of the combined distance, between two ends.
    ///
    /// Bodies of one class differ as adults do: lengths of trunk and limbs by 4 % and girths by 9 % (one standard deviation).
    /// They are families of the 28 plans of creatures, none of which decided about units and weights, in meshes of 250, 1,000
    /// and 5,000 vertices; two meshes may be of different resolutions. The ends are not 0 and 1: bodies of a worm or a ring are no
    /// farther apart than their poses, and poses of a spider no nearer than its bodies. One more plan about which distance
    /// says nothing is counted (rule of succession). `docs/decisions/014-metric.md` shows how often it is right.
    pub const SAME_SHAPE: Boundary = calibration::SAME_SHAPE;

    /// The boundary between one class and two classes, both being equally frequent; of one class, one body and two bodies are
    /// equally frequent. Measured as [`SAME_SHAPE`](Self::SAME_SHAPE).
    pub const SAME_CLASS: Boundary = calibration::SAME_CLASS;

    /// Sizes of poses and scans of one body differ by less than this factor, so that such sizes count as equal. It is also the
    /// unit of differences in size. A convention: poses and scans of one body may well differ by 5 %.
    pub const SIZE_OF_POSES: f64 = 1.05;

    /// Length of a fused vector without the size.
    pub const FUSED_LENGTH: usize = SignatureKind::GeodesicSpectrum.n_values()
        + SignatureKind::ShapeDna.n_values()
        + SignatureKind::HeatKernel.n_values()
        + SignatureKind::WaveKernel.n_values();

    /// Weight of the distance between aligned forms, relative to the weights of the signatures, which sum to one.
    pub const FORM_WEIGHT: f64 = calibration::FORM[1];

    /// Root mean square distance between the aligned forms, at unit area, of two poses of one body.
    pub const FORM_UNIT: f64 = calibration::FORM[0];

    /// Root mean square distance between two poses of one body by this signature; of the rigid one, between copies of a part.
    pub fn unit(kind: SignatureKind) -> f64 {
        match kind {
            SignatureKind::FormSpectrum => calibration::FORM_SPECTRUM,
            SignatureKind::Rigid => calibration::RIGID[0],
            _ => fused_entry(kind).map_or(f64::NAN, |(_, unit, _)| unit),
        }
    }

    /// The weight of this signature. All weights but that of the rigid signature sum to one. Signatures without weight are no
    /// part of fused vectors, nor is the rigid one.
    pub fn weight(kind: SignatureKind) -> f64 {
        match kind {
            SignatureKind::Rigid => calibration::RIGID[1],
            _ => fused_entry(kind).map_or(0.0, |(.., weight)| weight),
        }
    }

    /// The size of a surface as a coordinate whose differences are distances: `ln √area` in units of 5 %. The areas of two
    /// surfaces must be in the same unit of length.
    pub fn size_coordinate(area: f64) -> f64 {
        0.5 * area.max(f64::MIN_POSITIVE).ln() / Self::SIZE_OF_POSES.ln()
    }

    /// All signatures with a weight but the rigid one, as one vector whose Euclidean distance is the fused distance. With an
    /// `area` size counts too. Values are rounded to 32 bits: half the memory to scan, and an error far below the noise.
    pub fn fuse(signatures: &[Signature], area: Option<f64>) -> Vec<f32> {
        let weighted = signatures.iter().filter(|signature| fused_entry(signature.kind).is_some());
        let parts = weighted.flat_map(|signature| {
            let factor = Self::weight(signature.kind).sqrt() / Self::unit(signature.kind);
            signature.values.iter().map(move |value| (value * factor) as f32)
        });
        parts.chain(area.map(|area| Self::size_coordinate(area) as f32)).collect()
    }

    /// The Euclidean distance between two fused vectors, or between two signatures rounded to 32 bits.
    pub fn fused(a: &[f32], b: &[f32]) -> f64 {
        a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>().sqrt()
    }

    /// A fused vector without its coordinate of size.
    pub fn without_size(fused: &[f32]) -> &[f32] {
        &fused[..Self::FUSED_LENGTH.min(fused.len())]
    }

    /// The fused distance with Huber's loss (Huber 1964, `huber1964` in `REFERENCES.bib`): differences of two values beyond
    /// four standard deviations count linearly, as if their loss went on along its tangent. Size is not limited.
    ///
    /// By its unit, the squared distance of two poses by a signature of `m` values and weight `w` is `w` in the mean, so the
    /// standard deviation of one of its values is `√(w / m)`. A weld changes some values by many standard deviations and
    /// most others little; between two poses, hardly any value is beyond the limit, so that little changes.
    pub fn robust(a: &[f32], b: &[f32]) -> f64 {
        let (mut sum, mut rest) = (0.0, [a, b]);
        for (kind, _, weight) in calibration::FUSED {
            let n = kind.n_values().min(rest[0].len()).min(rest[1].len());
            let [(a, after_a), (b, after_b)] = rest.map(|values| values.split_at(n));
            sum += huber(a, b, 1.0, limit(kind, weight));
            rest = [after_a, after_b];
        }
        (sum + huber(rest[0], rest[1], 1.0, f64::INFINITY)).sqrt()
    }

    /// The difference of every value of a fused vector from which on it counts linearly in [`robust`](Self::robust); without the
    /// size, which is not limited.
    pub fn limits() -> Vec<f32> {
        let of_kind = |(kind, _, weight): (SignatureKind, _, _)| {
            std::iter::repeat_n(limit(kind, weight) as f32, kind.n_values())
        };
        calibration::FUSED.into_iter().flat_map(of_kind).collect()
    }

    /// The part of the robust distance that rigid signatures add: 0 unless both shapes have one, since nothing is known of how
    /// a surface that bends would look. Bending moves the shape of a surface in space farther than another class, so it is at most
    /// the [boundary](Self::SAME_SHAPE) of two shapes: parts that differ in space are two, but may be of one class.
    pub fn rigid(a: &[f32], b: &[f32]) -> f64 {
        let [unit, weight] = calibration::RIGID;
        let limit = limit(SignatureKind::Rigid, weight);
        huber(a, b, weight.sqrt() / unit, limit).sqrt().min(Self::SAME_SHAPE.at)
    }

    /// The combined distance, from a robust distance and the root mean square distance of the aligned forms of unit area.
    pub fn combined(robust: f64, form_rms: f64) -> f64 {
        robust.hypot(Self::form_part(form_rms))
    }

    fn form_part(form_rms: f64) -> f64 {
        form_rms / Self::FORM_UNIT * Self::FORM_WEIGHT.sqrt()
    }

    /// The distance between aligned forms at which the combined distance reaches `limit`; 0 if the robust distance alone
    /// is larger.
    pub fn form_limit(robust: f64, limit: f64) -> f64 {
        // Rounding must not exclude a shape exactly at the limit.
        const SLACK: f64 = 1.0 + 1e-9;
        let left = (limit.powi(2) - robust.powi(2)).max(0.0).sqrt();
        left * Self::FORM_UNIT / Self::FORM_WEIGHT.sqrt() * SLACK
    }

    /// The distance between aligned forms below which two shapes would be at least as likely of one class as not, from what they
    /// have now: a combined distance, and one between aligned forms. 0 if their signatures alone are too far apart.
    pub fn same_below(combined: f64, form_rms: f64) -> f64 {
        let robust = (combined.powi(2) - Self::form_part(form_rms).powi(2)).max(0.0).sqrt();
        Self::form_limit(robust, Self::SAME_CLASS.at)
    }
}

fn fused_entry(kind: SignatureKind) -> Option<(SignatureKind, f64, f64)> {
    calibration::FUSED.into_iter().find(|(known, ..)| *known == kind)
}

/// The difference of two values of a signature from which on it counts linearly.
fn limit(kind: SignatureKind, weight: f64) -> f64 {
    OUTLYING * (weight / kind.n_values() as f64).sqrt()
}

/// Sums that processors add up together.
const LANES: usize = 4;

/// The sum of Huber's losses of differences times `factor`. The order of summation does not depend on the processor.
fn huber(a: &[f32], b: &[f32], factor: f64, limit: f64) -> f64 {
    let loss = |(x, y): (&f32, &f32)| {
        let change = f64::from(x - y).abs() * factor;
        let inside = change.min(limit);
        inside * (2.0 * change - inside)
    };
    let ((a, rest_a), (b, rest_b)) = (a.as_chunks::<LANES>(), b.as_chunks::<LANES>());
    let mut sums = [0.0; LANES];
    for (a, b) in a.iter().zip(b) {
        for ((sum, x), y) in sums.iter_mut().zip(a).zip(b) {
            *sum += loss((x, y));
        }
    }
    sums.into_iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(loss).sum::<f64>()
}
