//! The distance between two shapes. Everything that was calibrated for it is here.

use serde::Serialize;

use crate::boundary::Boundary;
use crate::signature::{Signature, SignatureKind};

/// A distance between two aligned forms.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum FormDistance {
    /// Root mean square distance from the samples of either form to the nearest points of the other.
    #[default]
    NearestNeighborRms,
    /// The distance that 95 % of the samples of either form do not exceed, the larger of the two directions: a
    /// Hausdorff distance that tolerates a few outliers.
    Hausdorff95,
}

/// Unit and weight of every signature.
///
/// The unit is the root mean square distance between two poses of one body, each triangulated on its own.
///
/// The weight is the separation of the signature times its number of components, divided by the sum of these products
/// over all signatures. The separation is the mean squared distance between two families over that between two poses
/// of one family, as in Fisher's discriminant. The number of components is `tr(C)² / tr(C²)` with `C` the covariance of
/// the values within families: poses move the signature in that many independent ways, so that squared distances
/// would grow with it if the values were whitened.
///
/// Signatures of the form have no weight and are no part of fused vectors: two bodies of one family differ in them hardly more
/// than two poses of one body.
///
/// All but those of the rigid signature (see [`RIGID`]) were measured on the built-in articulated families, in meshes of 1,500
/// to 8,000 vertices, and on nothing else. `cargo run --release -p experiments -- units` measures them again.
const CALIBRATION: [(SignatureKind, f64, f64); SignatureKind::ALL.len()] = [
    (SignatureKind::Moments, 0.115, 0.0),
    (SignatureKind::D2, 0.067, 0.0),
    (SignatureKind::FormSpectrum, 0.144, 0.0),
    (SignatureKind::GeodesicSpectrum, 0.237, 0.07),
    (SignatureKind::ShapeDna, 0.084, 0.248),
    (SignatureKind::HeatKernel, 0.191, 0.204),
    (SignatureKind::WaveKernel, 0.254, 0.478),
    (SignatureKind::Rigid, RIGID[0], RIGID[1]),
];

/// Unit and weight of the rigid signature, which comes last and on top of the others, whose weights sum to one: it is zero for
/// surfaces that bend.
///
/// The unit is the root mean square distance between copies of a mechanical part. With the weight, parts of one family are by
/// this signature as far apart, root mean square, as the [boundary](ShapeMetric::SAME_SHAPE) of two bodies of one class.
/// Measured on 110 generated parts with four copies each (`cargo run --release -p experiments -- units`), on which copies are
/// .0014 apart and parts of one family .0274.
const RIGID: [f64; 2] = [0.0014, 0.0045];

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
/// The *fused* distance is `√(Σ_k w_k (d_k / u_k)² + s²)`, the Euclidean distance of two [fused](Self::fuse) vectors. An index is
/// searched by it. The *robust* distance is the same with [Huber's](Self::robust) loss of every value, so that a few
/// values that a weld or a hole changes count less; it is never larger. The *combined* distance is
/// `√(robust² + w_f (f / u_f)²)`. Two poses of one body are about one apart by each.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShapeMetric {
    /// The distance between aligned forms that is reported. The combined distance always takes the root mean square.
    pub distance: FormDistance,
}

/// How far apart two shapes are, regardless of size.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ShapeDistance {
    /// By signatures alone.
    #[serde(rename = "fused_distance")]
    pub fused: f64,
    /// By signatures and aligned forms.
    #[serde(rename = "combined_distance")]
    pub combined: f64,
}

impl ShapeDistance {
    /// Probability that both are one shape. One shape is of one class, so it is at most that of one class.
    #[must_use]
    pub fn same_shape(&self) -> f64 {
        ShapeMetric::SAME_SHAPE.probability(self.combined).min(self.same_class())
    }

    /// Probability that both are of one class.
    #[must_use]
    pub fn same_class(&self) -> f64 {
        ShapeMetric::SAME_CLASS.probability(self.combined)
    }

    /// Whether the shapes are certainly one shape.
    #[must_use]
    pub fn is_same_shape(&self) -> bool {
        self.combined < ShapeMetric::SAME_SHAPE.gap()[0]
    }

    /// Whether the shapes are at least as likely of one class as not. Neighbours as near as this vote on the class of a query.
    #[must_use]
    pub fn may_be_same_class(&self) -> bool {
        self.combined < ShapeMetric::SAME_CLASS.at
    }

    /// Whether the shapes are certainly of different classes.
    #[must_use]
    pub fn is_different(&self) -> bool {
        self.combined > ShapeMetric::SAME_CLASS.gap()[1]
    }
}

impl ShapeMetric {
    /// Version of the calibration and of the signatures. Fused vectors of different versions cannot be compared.
    pub const VERSION: u32 = 5;

    /// The boundary between two poses of one body and two bodies of one class.
    ///
    /// Fisher's linear discriminant of the logarithms of combined distances, poses and bodies being equally frequent. The
    /// bodies are those of `datasets::articulated_body`: lengths of trunk and limbs differ by 4 % and girths by 9 % (one
    /// standard deviation), as among adults. Two poses are at most 1.87 apart, with a median of 0.92; two bodies at
    /// least 0.78, with a median of 1.95. So a shape cannot always be told from another of its class.
    ///
    /// Probabilities hold for bodies and poses that vary as much as those. Measured on the built-in families as the units of
    /// signatures (`cargo run --release -p experiments -- units`), and on nothing else.
    pub const SAME_SHAPE: Boundary = Boundary { at: 1.313, steepness: 8.64 };

    /// The boundary between two bodies of one class and two classes: the geometric mean of the distance that 1 % of pairs
    /// of poses exceed and the one below which 1 % of the pairs from two families are. 95 % of two bodies of one family
    /// are nearer than 2.84, two families are at least 4.77 apart.
    ///
    /// The steepness is Fisher's with the variance of bodies for both, since three families say little about the
    /// variance among families. Measured as [`SAME_SHAPE`](Self::SAME_SHAPE).
    pub const SAME_CLASS: Boundary = Boundary { at: 2.874, steepness: 20.07 };

    /// Sizes of poses and scans of one body differ by less than this factor, so that such sizes count as equal. It is also the
    /// unit of differences in size. A convention: poses and scans of one body may well differ by 5 %.
    pub const SIZE_OF_POSES: f64 = 1.05;

    /// An answer is [certain](Boundary::CERTAIN) if it is at least this probable.
    pub const CERTAIN: f64 = Boundary::CERTAIN;

    /// Points of every form that are aligned with the nearest points of another form.
    pub const ALIGNED_POINTS: usize = 400;

    /// Number of values of a fused vector that bending does not change, which come first.
    const INTRINSIC_LENGTH: usize = Self::FUSED_LENGTH - SignatureKind::Rigid.n_values();

    /// Length of a fused vector without the size.
    pub const FUSED_LENGTH: usize = {
        let mut sum = 0;
        let mut i = 0;
        while i < CALIBRATION.len() {
            if CALIBRATION[i].2 > 0.0 {
                sum += CALIBRATION[i].0.n_values();
            }
            i += 1;
        }
        sum
    };

    /// Weight of the distance between aligned forms, relative to the weights of the signatures, which sum to one. It was
    /// measured as they were; a distance has one component.
    pub const FORM_WEIGHT: f64 = 0.0095;

    /// Root mean square distance between two poses of one body by this signature: see the table in the source.
    pub fn unit(kind: SignatureKind) -> f64 {
        CALIBRATION[kind as usize].1
    }

    /// The weight of this signature. All weights but that of the rigid signature sum to one. Signatures without weight are no
    /// part of fused vectors.
    pub fn weight(kind: SignatureKind) -> f64 {
        CALIBRATION[kind as usize].2
    }

    /// Root mean square, over pairs of poses of one body, of the distance between their aligned forms of unit area.
    /// Measured as the units of signatures; the separation of families is 14.5 by the root mean square and 14.9 by the
    /// Hausdorff distance.
    pub fn form_unit(distance: FormDistance) -> f64 {
        match distance {
            FormDistance::NearestNeighborRms => 0.027,
            FormDistance::Hausdorff95 => 0.0548,
        }
    }

    /// The size of a surface as a coordinate whose differences are distances: `ln √area` in units of 5 %. The areas of two
    /// surfaces must be in the same unit of length.
    pub fn size_coordinate(area: f64) -> f64 {
        0.5 * area.max(f64::MIN_POSITIVE).ln() / Self::SIZE_OF_POSES.ln()
    }

    /// All signatures with a weight, in their order, as one vector whose Euclidean distance is the fused distance. With an
    /// `area` size counts too. Values are rounded to 32 bits: half the memory to scan, and an error far below the noise.
    pub fn fuse(signatures: &[Signature], area: Option<f64>) -> Vec<f32> {
        let weighted = signatures.iter().filter(|signature| Self::weight(signature.kind) > 0.0);
        let parts = weighted.flat_map(|signature| {
            let factor = Self::weight(signature.kind).sqrt() / Self::unit(signature.kind);
            signature.values.iter().map(move |value| (value * factor) as f32)
        });
        parts.chain(area.map(|area| Self::size_coordinate(area) as f32)).collect()
    }

    /// The signature with the size of the surface as one more value, in the unit of the signature: a difference of
    /// 5 % in size is as much as the difference between two poses.
    #[must_use]
    pub fn with_size(mut signature: Signature, area: f64) -> Signature {
        signature.values.push(Self::unit(signature.kind) * Self::size_coordinate(area));
        signature
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
    /// Two poses of one body are about one apart, so the standard deviation of a value is `1 / √n` with `n` the
    /// number of values that bending does not change. A weld changes some values by many standard deviations and most
    /// others little; between two poses, hardly any value is beyond the limit, so that little changes.
    ///
    /// The values of the rigid signature count if neither surface bends.
    pub fn robust(a: &[f32], b: &[f32]) -> f64 {
        let limit = OUTLYING / (Self::INTRINSIC_LENGTH as f64).sqrt();
        let bends = [a, b].iter().any(|values| Self::bends(values));
        let loss = |(i, (a, b)): (usize, (&f32, &f32))| {
            let change = f64::from(a - b).abs();
            match i {
                _ if (Self::INTRINSIC_LENGTH..Self::FUSED_LENGTH).contains(&i) && bends => 0.0,
                _ if i < Self::FUSED_LENGTH && change > limit => limit * (2.0 * change - limit),
                _ => change * change,
            }
        };
        a.iter().zip(b).enumerate().map(loss).sum::<f64>().sqrt()
    }

    /// Whether the surface of a fused vector bends, so that it has no rigid signature.
    fn bends(fused: &[f32]) -> bool {
        fused.iter().take(Self::FUSED_LENGTH).skip(Self::INTRINSIC_LENGTH).all(|value| *value == 0.0)
    }

    /// The combined distance, from a robust distance and the root mean square distance of the aligned forms of unit area.
    pub fn combined(robust: f64, form_rms: f64) -> f64 {
        robust.hypot(Self::form_part(form_rms))
    }

    /// The robust distance within a combined distance: the inverse of [`combined`](Self::combined).
    pub fn robust_part(combined: f64, form_rms: f64) -> f64 {
        (combined.powi(2) - Self::form_part(form_rms).powi(2)).max(0.0).sqrt()
    }

    fn form_part(form_rms: f64) -> f64 {
        form_rms / Self::form_unit(FormDistance::NearestNeighborRms) * Self::FORM_WEIGHT.sqrt()
    }

    /// The distance between aligned forms at which the combined distance reaches `limit`; 0 if the robust distance alone
    /// is larger. For a distance other than the root mean square it is the one as many units large.
    pub fn form_limit(robust: f64, limit: f64, distance: FormDistance) -> f64 {
        // Rounding must not exclude a shape exactly at the limit.
        const SLACK: f64 = 1.0 + 1e-9;
        let left = (limit.powi(2) - robust.powi(2)).max(0.0).sqrt();
        left * Self::form_unit(distance) / Self::FORM_WEIGHT.sqrt() * SLACK
    }

    /// The reported distance between aligned forms below which shapes with this robust distance
    /// [may be of one class](ShapeDistance::may_be_same_class); 0 if their signatures alone are too far apart.
    pub fn same_below(&self, robust: f64) -> f64 {
        Self::form_limit(robust, Self::SAME_CLASS.at, self.distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_lists_every_signature_and_weights_sum_to_one() {
        assert!(SignatureKind::ALL.into_iter().eq(CALIBRATION.map(|(kind, ..)| kind)));
        assert_eq!(SignatureKind::ALL.last(), Some(&SignatureKind::Rigid));
        let total: f64 = SignatureKind::ALL.into_iter().map(ShapeMetric::weight).sum();
        assert!((total - RIGID[1] - 1.0).abs() < 1e-9);
    }

    #[test]
    fn outlying_values_count_linearly() {
        let limit = OUTLYING / (ShapeMetric::INTRINSIC_LENGTH as f64).sqrt();
        let at = |change: f64| ShapeMetric::robust(&[0.0, 1.0], &[change as f32, 1.0]);
        assert!((at(0.5 * limit) / (0.5 * limit) - 1.0).abs() < 1e-6, "small changes count fully");
        for times in [2.0, 5.0, 20.0] {
            let expected = limit * (2.0 * times - 1.0f64).sqrt();
            assert!((at(times * limit) / expected - 1.0).abs() < 1e-6, "{times}");
        }
        let many = |change: f32| [vec![0.0; ShapeMetric::FUSED_LENGTH], vec![change]].concat();
        assert!((ShapeMetric::robust(&many(0.0), &many(7.0)) - 7.0).abs() < 1e-12, "size is not limited");
    }

    #[test]
    fn space_counts_between_surfaces_that_do_not_bend() {
        let vector = |rigid: f32| [vec![0.0; ShapeMetric::INTRINSIC_LENGTH], vec![rigid; 27]].concat();
        let robust = |a: f32, b: f32| ShapeMetric::robust(&vector(a), &vector(b));
        assert!((robust(0.2, 0.3) - ShapeMetric::fused(&vector(0.2), &vector(0.3))).abs() < 1e-6);
        assert!(robust(0.2, 0.3) > 0.05);
        assert_eq!((robust(0.2, 0.0), robust(0.0, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn a_combined_distance_has_its_parts() {
        for (robust, form) in [(0.0, 0.0), (1.0, 0.03), (0.0, 0.1), (3.0, 0.0)] {
            let combined = ShapeMetric::combined(robust, form);
            assert!((ShapeMetric::robust_part(combined, form) - robust).abs() < 1e-9);
        }
        assert_eq!(ShapeMetric::robust_part(0.1, 9.0), 0.0);
    }

    #[test]
    fn answers_follow_each_other_as_the_distance_grows() {
        let at = |combined| ShapeDistance { fused: combined, combined };
        let mut last = at(0.0);
        assert_eq!((last.same_shape(), last.same_class()), (1.0, 1.0));
        for i in 1..4000 {
            let next = at(f64::from(i) * 0.005);
            assert!(next.same_shape() <= last.same_shape() && next.same_class() <= last.same_class());
            assert!(next.same_shape() <= next.same_class());
            assert!(!next.is_same_shape() || next.may_be_same_class());
            assert!(!(next.may_be_same_class() && next.is_different()));
            assert_eq!(next.may_be_same_class(), next.same_class() > 0.5);
            last = next;
        }
        assert!(last.is_different());
    }

    #[test]
    fn a_form_at_the_limit_has_the_distance_at_which_classes_become_as_likely() {
        let metric = ShapeMetric::default();
        let at = ShapeMetric::SAME_CLASS.at;
        for fused in [0.0, 0.3 * at, 0.85 * at] {
            let limit = metric.same_below(fused);
            assert!(ShapeMetric::combined(fused, limit * 1.001) > at);
            assert!(ShapeMetric::combined(fused, limit * 0.999) < at);
        }
        assert_eq!(metric.same_below(1.15 * at), 0.0);
        let ratio =
            ShapeMetric { distance: FormDistance::Hausdorff95 }.same_below(1.0) / metric.same_below(1.0);
        let units = [FormDistance::Hausdorff95, FormDistance::NearestNeighborRms].map(ShapeMetric::form_unit);
        assert!((ratio - units[0] / units[1]).abs() < 1e-12);
    }
}
