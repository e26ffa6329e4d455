//! The verdict on two shapes.

use std::fmt;

use serde::Serialize;

use crate::metric::{Handedness, MatchKind, SAME_SIZE, ShapeDistance, ShapeMetric};

/// How alike two shapes are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum VerdictKind {
    /// One body in two poses, at any size, or its mirror image.
    SameShape,
    /// Two bodies of one class, such as two cats.
    SameClass,
    /// The distance is near a boundary: between one shape and one class, or between one class and different ones.
    Undecided,
    /// Shapes of different classes.
    Different,
}

/// The verdict on two shapes and all that explains it: one decision for every program. [`Display`](fmt::Display) words it.
///
/// The combined distance `d` decides. At the [`Boundary`](crate::Boundary) between one shape and one class, and at that between one class
/// and two, the odds are `(at / d)^steepness`. Both were measured on poses, bodies and families of the built-in shapes,
/// see [`ShapeMetric::SAME_SHAPE`] and [`ShapeMetric::SAME_CLASS`]: probabilities assume that the answers on either side
/// are equally frequent, and hold for bodies and poses that vary as much as those. What is less than 90 % probable is
/// undecided.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(into = "VerdictRecord")]
pub struct Verdict {
    /// The decision.
    pub kind: VerdictKind,
    /// Probability of the decision, 0 to 1. Of an undecided pair, that of the likelier answer.
    pub confidence: f64,
    /// The combined distance, which decides.
    pub distance: f64,
    /// The limit of the combined distance that applies to the kind: a firm verdict of one shape or one class holds below
    /// it, a firm difference above it. For an undecided pair, where both answers are equally likely.
    pub threshold: f64,
    /// Probability that both are one shape.
    pub same_shape: f64,
    /// Probability that both are of one class.
    pub same_class: f64,
    /// Whether the second is the mirror image of the first.
    pub handedness: Handedness,
    /// Size of the second over that of the first.
    pub scale: f64,
}

impl ShapeMetric {
    /// The verdict on two shapes; `scale` is the size of the second over that of the first.
    ///
    /// ```
    /// use canonform_descriptors::{Handedness, ShapeDistance, ShapeMetric, VerdictKind};
    ///
    /// let verdict = |d| {
    ///     ShapeMetric::verdict(ShapeDistance { fused: d, combined: d }, Handedness::Unknown, 1.0)
    /// };
    /// assert_eq!(verdict(0.5).to_string(), "the same shape up to pose");
    /// assert_eq!(verdict(20.0).kind, VerdictKind::Different);
    /// assert!(verdict(0.5).confidence > verdict(1.0).confidence);
    /// ```
    pub fn verdict(distance: ShapeDistance, handedness: Handedness, scale: f64) -> Verdict {
        let d = distance.combined;
        let (shape, class) = (Self::SAME_SHAPE, Self::SAME_CLASS);
        let same_class = class.probability(d);
        // One shape is of one class.
        let same_shape = shape.probability(d).min(same_class);
        let (shape_gap, class_gap) = (shape.gap(), class.gap());
        let (kind, confidence, threshold) = if d < shape_gap[0] {
            (VerdictKind::SameShape, same_shape, shape_gap[0])
        } else if d > class_gap[1] {
            (VerdictKind::Different, 1.0 - same_class, class_gap[1])
        } else if d >= class_gap[0] {
            (VerdictKind::Undecided, same_class.max(1.0 - same_class), class.at)
        } else if d <= shape_gap[1] {
            (VerdictKind::Undecided, same_shape.max(1.0 - same_shape), shape.at)
        } else {
            (VerdictKind::SameClass, same_class - same_shape, class_gap[0])
        };
        Verdict { kind, confidence, distance: d, threshold, same_shape, same_class, handedness, scale }
    }
}

impl Verdict {
    /// Whether the shapes are firmly of one class: one shape, or undecided only between one shape and one class.
    pub fn is_same_class(&self) -> bool {
        self.distance < ShapeMetric::SAME_CLASS.gap()[0]
    }

    /// Whether the shapes are at least as likely of one class as not. Neighbours with such a verdict vote on the class
    /// of a query, and [`match_kind`](Self::match_kind) is not `different`.
    pub fn may_be_same_class(&self) -> bool {
        self.distance < ShapeMetric::SAME_CLASS.at
    }

    /// By which change of size and handedness the second matches the first, if they
    /// [may be of one class](Self::may_be_same_class).
    pub fn match_kind(&self) -> MatchKind {
        match (self.may_be_same_class(), self.is_mirrored(), self.is_resized()) {
            (false, _, _) => MatchKind::Different,
            (true, false, false) => MatchKind::Same,
            (true, false, true) => MatchKind::Scaled,
            (true, true, false) => MatchKind::Mirrored,
            (true, true, true) => MatchKind::MirroredAndScaled,
        }
    }

    /// The number that decided, and what it was compared with.
    pub fn reason(&self) -> String {
        let [shape, class] = [ShapeMetric::SAME_SHAPE, ShapeMetric::SAME_CLASS].map(|b| b.gap());
        let Self { distance, confidence, .. } = self;
        let limits = format!("same shape below {:.3}, different above {:.3}", shape[0], class[1]);
        format!("combined distance {distance:.3} ({limits}); confidence {confidence:.2}")
    }

    fn is_mirrored(&self) -> bool {
        self.handedness == Handedness::Mirrored
    }

    /// Whether the sizes differ by more than those of poses and scans of one body may.
    pub fn is_resized(&self) -> bool {
        self.scale.max(1.0 / self.scale) > SAME_SIZE
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let shape = if self.is_mirrored() { "mirror images" } else { "the same shape" };
        let is_near = match self.kind {
            VerdictKind::SameShape => {
                write!(f, "{shape} up to pose")?;
                true
            }
            VerdictKind::Undecided if self.threshold == ShapeMetric::SAME_SHAPE.at => {
                write!(f, "the same class, perhaps {shape}")?;
                true
            }
            VerdictKind::SameClass => {
                write!(f, "the same class, probably not the same shape")?;
                false
            }
            VerdictKind::Undecided => {
                write!(f, "different shapes, perhaps of the same class")?;
                false
            }
            VerdictKind::Different => {
                write!(f, "different shapes")?;
                false
            }
        };
        if is_near && self.is_resized() {
            write!(f, ", scaled by {:.3}", self.scale)?;
        }
        Ok(())
    }
}

/// A verdict with its words.
#[derive(Serialize)]
struct VerdictRecord {
    kind: VerdictKind,
    confidence: f64,
    distance: f64,
    threshold: f64,
    same_shape: f64,
    same_class: f64,
    handedness: Handedness,
    scale: f64,
    text: String,
    reason: String,
}

impl From<Verdict> for VerdictRecord {
    fn from(verdict: Verdict) -> Self {
        let Verdict { kind, confidence, distance, threshold, same_shape, same_class, handedness, scale } =
            verdict;
        let (text, reason) = (verdict.to_string(), verdict.reason());
        Self {
            kind,
            confidence,
            distance,
            threshold,
            same_shape,
            same_class,
            handedness,
            scale,
            text,
            reason,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::Boundary;

    fn verdict(combined: f64, handedness: Handedness, scale: f64) -> Verdict {
        ShapeMetric::verdict(ShapeDistance { fused: combined, combined }, handedness, scale)
    }

    fn plain(combined: f64) -> Verdict {
        verdict(combined, Handedness::Unknown, 1.0)
    }

    #[test]
    fn a_boundary_gives_the_probability_of_each_distance() {
        let boundary = Boundary { at: 2.0, steepness: 5.0 };
        assert_eq!(boundary.probability(0.0), 1.0);
        assert_eq!(boundary.probability(2.0), 0.5);
        assert_eq!(boundary.probability(f64::INFINITY), 0.0);
        for probability in [0.05, 0.5, 0.9] {
            assert!((boundary.probability(boundary.distance(probability)) - probability).abs() < 1e-12);
        }
    }

    #[test]
    fn verdicts_follow_each_other_as_the_distance_grows() {
        let mut kinds = Vec::new();
        let mut last = plain(0.0);
        assert_eq!((last.kind, last.confidence), (VerdictKind::SameShape, 1.0));
        for i in 0..4000 {
            let next = plain(f64::from(i) * 0.005);
            assert!(next.same_shape <= last.same_shape && next.same_class <= last.same_class);
            assert!(next.same_shape <= next.same_class);
            assert!((0.5..=1.0).contains(&next.confidence), "{next:?}");
            if kinds.last() != Some(&next.kind) {
                kinds.push(next.kind);
            }
            let firm = next.kind != VerdictKind::Undecided;
            assert_eq!(next.reason().matches("below").count(), 1);
            assert!(!firm || next.confidence > 0.75, "{next:?}");
            let below = next.distance < next.threshold;
            match next.kind {
                VerdictKind::SameShape | VerdictKind::SameClass => assert!(below, "{next:?}"),
                VerdictKind::Different => assert!(!below, "{next:?}"),
                VerdictKind::Undecided => (),
            }
            assert_eq!(next.match_kind() == MatchKind::Different, next.same_class <= 0.5);
            last = next;
        }
        assert_eq!((kinds[0], kinds[kinds.len() - 1]), (VerdictKind::SameShape, VerdictKind::Different));
        assert_eq!(kinds[1], VerdictKind::Undecided);
    }

    #[test]
    fn the_words_follow_distance_size_and_handedness() {
        let near = 0.5;
        for unclear in [Handedness::Same, Handedness::Either, Handedness::Unknown] {
            assert_eq!(verdict(near, unclear, 1.0).to_string(), "the same shape up to pose");
            assert_eq!(
                verdict(near, unclear, 1.129).to_string(),
                "the same shape up to pose, scaled by 1.129"
            );
            assert_eq!(verdict(near, unclear, 0.5).match_kind(), MatchKind::Scaled);
        }
        let mirrored = verdict(near, Handedness::Mirrored, 1.02);
        assert_eq!(
            (mirrored.match_kind(), mirrored.to_string()),
            (MatchKind::Mirrored, "mirror images up to pose".into())
        );
        assert_eq!(verdict(near, Handedness::Mirrored, 2.0).match_kind(), MatchKind::MirroredAndScaled);
        let unsure = plain(ShapeMetric::SAME_SHAPE.at);
        assert_eq!(unsure.to_string(), "the same class, perhaps the same shape");
        assert_eq!((unsure.kind, unsure.match_kind()), (VerdictKind::Undecided, MatchKind::Same));
        assert_eq!(
            plain(ShapeMetric::SAME_CLASS.at).to_string(),
            "different shapes, perhaps of the same class"
        );
        for scale in [1.0, 3.0] {
            let apart = verdict(30.0, Handedness::Mirrored, scale);
            assert_eq!(
                (apart.match_kind(), apart.to_string()),
                (MatchKind::Different, "different shapes".into())
            );
        }
    }

    #[test]
    fn the_record_has_the_verdict_in_words() {
        let json = serde_json::to_value(plain(0.25)).unwrap();
        assert_eq!(
            (&json["kind"], &json["text"]),
            (&"same-shape".into(), &"the same shape up to pose".into())
        );
        assert_eq!((&json["distance"], &json["handedness"]), (&0.25.into(), &"unknown".into()));
        assert!(json["reason"].as_str().unwrap().starts_with("combined distance 0.250 (same shape below "));
    }
}
