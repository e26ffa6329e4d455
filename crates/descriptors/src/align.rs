//! Rigid alignment of two forms, and the distance between aligned forms.

use nalgebra::{Matrix3, Point3};

use crate::alignment::Alignment;
use crate::prepared::{Detail, PreparedForm};

/// Whether an alignment may reflect.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Reflections {
    /// It may: distances determine a form only up to reflection.
    Allow,
    /// It must not.
    Forbid,
    /// It must.
    Require,
}

/// The best rigid alignment of two forms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormAlignment {
    /// Takes the first form, in its own coordinates, onto the second.
    pub alignment: Alignment,
    /// Root mean square distance from the samples of either form to the nearest points of the other, in their unit. The
    /// alignment minimises it.
    pub rms: f64,
}

/// Axes whose spreads differ by less than this factor in both forms may be exchanged, since their order is arbitrary. A
/// safety limit: more hypotheses cost time only.
const NEAR_EQUAL_AXES: f64 = 1.15;

/// Number of hypotheses that are refined until they converge, after a few steps of all of them.
const REFINED: usize = 8;

/// The effort of a stage of the alignment.
#[derive(Debug, Clone, Copy)]
struct Stage {
    /// Samples of either form that look for their nearest points.
    n_samples: usize,
    /// Points of the other form that are searched.
    among: Detail,
    /// Most steps.
    steps: usize,
}

/// For all hypotheses: enough steps to rank them, since their order before the first step says little about the order
/// at the end.
const SKETCH: Stage = Stage { n_samples: 50, among: Detail::Samples, steps: 4 };

/// For the best hypotheses.
const ROUGH: Stage = Stage { n_samples: 100, among: Detail::Samples, steps: 20 };

/// For the very best.
const FINE: Stage = Stage { n_samples: usize::MAX, among: Detail::Points, steps: 30 };

/// An error on the coarse sample beyond this multiple of the best hypothesis will not come below it. A safety limit.
const HOPELESS: f64 = 2.0;

/// A step that reduces the error by less than this share is the last. A tolerance.
const LEAST_GAIN: f64 = 1e-3;

/// Aligns two canonical forms rigidly and measures the distance between them.
///
/// * The principal axes of both are brought onto each other under all signs, and with near-equal axes exchanged: 8 to 48 hypotheses,
///   half of them without reflections, ranked by a few steps on a coarse sample.
/// * The best hypotheses are refined on a coarse sample by iterative closest points, and the best of these on all
///   samples. Pairs are taken in both directions, so neither form is favoured; samples are spread evenly and count the
///   same, so the triangulation does not matter; each step solves Kabsch's problem and keeps the handedness of its
///   hypothesis.
/// * The distance is symmetric up to the local minimum in which the refinement ends.
///
/// ```
/// use canonform_descriptors::{CanonicalForm, PreparedForm, Reflections, align_forms};
/// use nalgebra::Point3;
///
/// let spiral = |turn: f64| {
///     let at = |i: i32| Point3::new(f64::from(i), (turn + 0.1 * f64::from(i)).sin(), (turn + 0.1 * f64::from(i)).cos());
///     PreparedForm::new(&CanonicalForm::from_points((0..100).map(at).collect(), vec![1.0; 100])?)
/// };
/// let found = align_forms(&spiral(0.0)?, &spiral(2.0)?, Reflections::Allow);
/// assert!(found.rms < 0.1, "one is the other, turned about its axis");
/// # Ok::<(), canonform_descriptors::DescriptorError>(())
/// ```
#[must_use]
pub fn align_forms(a: &PreparedForm, b: &PreparedForm, reflections: Reflections) -> FormAlignment {
    refined_fully(a, b, refined_roughly(a, b, reflections).1)
}

/// Aligns two forms as [`align_forms`] does, with or without a reflection, or returns `None` if the root mean square distance
/// is larger than `limit`. Nothing is aligned if the [lower bound](PreparedForm::least_distance) of the distance is larger.
#[must_use]
pub fn align_near_forms(a: &PreparedForm, b: &PreparedForm, limit: f64) -> Option<FormAlignment> {
    let may_be_near = a.least_distance(b) <= limit;
    may_be_near.then(|| align_forms(a, b, Reflections::Allow)).filter(|found| found.rms <= limit)
}

/// The best hypothesis after all stages but the last, and its error.
fn refined_roughly(a: &PreparedForm, b: &PreparedForm, reflections: Reflections) -> (f64, Alignment) {
    let mut best = (f64::INFINITY, Alignment::about_origin(Matrix3::identity()));
    let sketched = refine_all(a, b, hypotheses(a, b, reflections), SKETCH);
    for (error, start) in sketched.into_iter().take(REFINED) {
        if error > HOPELESS * best.0 {
            break;
        }
        let found = refine(a, b, start, ROUGH);
        if found.0 < best.0 {
            best = found;
        }
    }
    best
}

/// Motions of the principal axes of the first form to those of the second, the best of each handedness, after all stages
/// but the last; by ascending error.
#[must_use]
pub fn alignments(a: &PreparedForm, b: &PreparedForm) -> Vec<Alignment> {
    let mut found = Vec::new();
    for reflections in [Reflections::Forbid, Reflections::Require] {
        let sketched = refine_all(a, b, hypotheses(a, b, reflections), SKETCH);
        found.extend(refine_all(a, b, sketched.into_iter().map(|(_, motion)| motion).take(REFINED), ROUGH));
    }
    found.sort_by(|x, y| x.0.total_cmp(&y.0));
    found.into_iter().map(|(_, motion)| motion).collect()
}

/// All starts, refined, by ascending error.
fn refine_all(
    a: &PreparedForm,
    b: &PreparedForm,
    starts: impl IntoIterator<Item = Alignment>,
    stage: Stage,
) -> Vec<(f64, Alignment)> {
    let mut found: Vec<_> = starts.into_iter().map(|start| refine(a, b, start, stage)).collect();
    found.sort_by(|x, y| x.0.total_cmp(&y.0));
    found
}

fn refined_fully(a: &PreparedForm, b: &PreparedForm, start: Alignment) -> FormAlignment {
    let (_, motion) = refine(a, b, start, FINE);
    let found = pairs(a, b, &motion, FINE);
    let (from_a, from_b) = found.split_at(a.samples().len());
    FormAlignment {
        alignment: b.to_principal.inverse().after(&motion).after(&a.to_principal),
        rms: (0.5 * (mean_square(from_a) + mean_square(from_b))).sqrt(),
    }
}

/// Signed permutations of the principal axes that may bring `a` onto `b`.
fn hypotheses(a: &PreparedForm, b: &PreparedForm, reflections: Reflections) -> Vec<Alignment> {
    // Principal axes may be left-handed: then a motion between them reflects if the motion in space does not.
    let flipped = a.to_principal.reflected != b.to_principal.reflected;
    let mut motions = axis_motions(a.axis_spread, b.axis_spread);
    motions.retain(|motion| match reflections {
        Reflections::Allow => true,
        Reflections::Forbid => motion.reflected == flipped,
        Reflections::Require => motion.reflected != flipped,
    });
    motions
}

/// The 8 to 48 motions of the principal axes of a form onto those of another, with these spreads: all signs, and exchanges of
/// axes with near-equal spreads in both forms.
pub(crate) fn axis_motions(a: [f64; 3], b: [f64; 3]) -> Vec<Alignment> {
    const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
    let exchangeable = |i: usize, j: usize| {
        let near = |spread: [f64; 3]| spread[i.min(j)] <= NEAR_EQUAL_AXES * spread[i.max(j)];
        near(a) && near(b)
    };
    let mut motions = Vec::new();
    for permutation in PERMUTATIONS {
        let allowed = (0..3).all(|i| {
            let j = permutation[i];
            // Axes 0 and 2 are exchangeable only if both are close to axis 1.
            i == j
                || (i.abs_diff(j) == 1 && exchangeable(i, j))
                || (i.abs_diff(j) == 2 && exchangeable(0, 1) && exchangeable(1, 2))
        });
        if !allowed {
            continue;
        }
        for signs in 0..8 {
            let mut matrix = Matrix3::zeros();
            for (i, j) in permutation.into_iter().enumerate() {
                matrix[(i, j)] = if signs >> i & 1 == 0 { 1.0 } else { -1.0 };
            }
            motions.push(Alignment::about_origin(matrix));
        }
    }
    motions
}

type Pair = (Point3<f64>, Point3<f64>, f64);

/// Closest pairs in both directions: a point of `a`, its partner in `b`, and their squared distance under `motion`.
fn pairs(a: &PreparedForm, b: &PreparedForm, motion: &Alignment, stage: Stage) -> Vec<Pair> {
    let back = motion.inverse();
    let from_a = a.samples().iter().take(stage.n_samples).map(|p| {
        let (partner, sq) = b.nearest(&motion.apply(p), stage.among);
        (*p, partner, sq)
    });
    let from_b = b.samples().iter().take(stage.n_samples).map(|q| {
        let (partner, sq) = a.nearest(&back.apply(q), stage.among);
        (partner, *q, sq)
    });
    from_a.chain(from_b).collect()
}

/// Iterative closest points from `start`. Returns the least root mean square distance and its motion.
fn refine(a: &PreparedForm, b: &PreparedForm, start: Alignment, stage: Stage) -> (f64, Alignment) {
    let mut motion = start;
    let mut best = (f64::INFINITY, start);
    for _ in 0..=stage.steps {
        let found = pairs(a, b, &motion, stage);
        let error = mean_square(&found).sqrt();
        let settled = error > best.0 * (1.0 - LEAST_GAIN);
        if error < best.0 {
            best = (error, motion);
        }
        if settled {
            break;
        }
        let close: Vec<_> = found.iter().map(|(x, y, _)| (*x, *y)).collect();
        match Alignment::fit(&close, start.reflected) {
            Some(next) => motion = next,
            None => break,
        }
    }
    best
}

fn mean_square(pairs: &[Pair]) -> f64 {
    pairs.iter().map(|pair| pair.2).sum::<f64>() / pairs.len().max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canonical_form::CanonicalForm;
    use nalgebra::{Rotation3, Vector3};

    /// A figure of three arms without symmetry.
    fn figure(n: usize, bend: f64) -> Vec<Point3<f64>> {
        (0..n)
            .map(|i| {
                let t = i as f64 / n as f64;
                let (arm, s) = ((t * 3.0).floor(), (t * 3.0).fract());
                match arm as usize {
                    0 => Point3::new(6.0 * s, bend * s * s, 0.3 * (9.0 * s).sin()),
                    1 => Point3::new(-2.0 * s, 3.0 * s, 0.2 * s),
                    _ => Point3::new(0.5 * s, -1.5 * s * s, 1.6 * s),
                }
            })
            .collect()
    }

    fn prepared(points: &[Point3<f64>]) -> PreparedForm {
        let form = CanonicalForm::from_points(points.to_vec(), vec![1.0; points.len()]).unwrap();
        PreparedForm::new(&form).unwrap()
    }

    fn turned(points: &[Point3<f64>], mirror: f64) -> Vec<Point3<f64>> {
        let turn = Rotation3::from_euler_angles(1.0, 0.4, -2.0);
        points
            .iter()
            .map(|p| turn * Point3::new(p.x, p.y, mirror * p.z) + Vector3::new(3.0, 1.0, 0.0))
            .collect()
    }

    #[test]
    fn a_moved_form_has_distance_zero_and_its_motion_is_found() {
        let points = figure(600, 1.0);
        for mirror in [1.0, -1.0] {
            let found =
                align_forms(&prepared(&points), &prepared(&turned(&points, mirror)), Reflections::Allow);
            assert_eq!(found.alignment.reflected, mirror < 0.0);
            let (a, b) = (
                CanonicalForm::from_points(points.clone(), vec![1.0; 600]).unwrap(),
                CanonicalForm::from_points(turned(&points, mirror), vec![1.0; 600]).unwrap(),
            );
            let gap = a.points().iter().zip(b.points()).map(|(p, q)| (found.alignment.apply(p) - q).norm());
            assert!(gap.fold(0.0, f64::max) < 1e-9);
        }
    }

    #[test]
    fn a_mirror_image_differs_if_reflections_are_forbidden() {
        let points = figure(600, 1.0);
        let by = |reflections, other: &PreparedForm| align_forms(&prepared(&points), other, reflections);
        // Whatever the handedness of the principal axes.
        for axis in 0..3 {
            let mut signs = Vector3::repeat(1.0);
            signs[axis] = -1.0;
            let mirrored: Vec<_> =
                points.iter().map(|p| Point3::from(p.coords.component_mul(&signs))).collect();
            let found = by(Reflections::Forbid, &prepared(&mirrored));
            assert!(found.rms > 0.05 && !found.alignment.reflected, "{axis}");
            let found = by(Reflections::Require, &prepared(&mirrored));
            assert!(found.rms < 1e-9 && found.alignment.reflected, "{axis}");
        }
        let same = by(Reflections::Require, &prepared(&points));
        assert!(same.rms > 0.05 && same.alignment.reflected);
    }

    #[test]
    fn the_distance_is_symmetric_and_grows_with_the_difference() {
        let base = prepared(&figure(600, 1.0));
        let mut last = 0.0;
        for bend in [1.5, 2.5, 4.0] {
            let other = prepared(&figure(500, bend));
            let there = align_forms(&base, &other, Reflections::Allow);
            let back = align_forms(&other, &base, Reflections::Allow);
            assert!((there.rms - back.rms).abs() < 0.02 * there.rms, "{} {}", there.rms, back.rms);
            assert!(there.rms > last);
            last = there.rms;
        }
    }

    #[test]
    fn the_lower_bound_holds_and_far_pairs_are_abandoned() {
        let forms: Vec<_> = [0.2, 1.0, 2.5, 4.0, 9.0].map(|bend| prepared(&figure(500, bend))).into();
        let mut bounded = 0;
        for (a, b) in forms.iter().flat_map(|a| forms.iter().map(move |b| (a, b))) {
            let whole = align_forms(a, b, Reflections::Allow);
            let least = a.least_distance(b);
            assert!(least <= whole.rms + 1e-12, "{least} {}", whole.rms);
            assert_eq!(least, b.least_distance(a));
            bounded += usize::from(least > 0.1 * whole.rms);
            let within = |limit| align_near_forms(a, b, limit);
            assert_eq!(within(f64::INFINITY), Some(whole));
            assert_eq!(within(whole.rms), Some(whole), "at the limit");
            assert_eq!(within(0.9 * whole.rms - 1e-9), None);
        }
        assert!(bounded > 0, "the bound is not trivial");
    }

    #[test]
    fn near_equal_axes_are_exchanged() {
        // Two crosses whose longer arm is not the same one: the heads at the ends of the arms only meet if axes
        // are exchanged.
        let cross = |along: f64, across: f64| -> Vec<Point3<f64>> {
            (0..300)
                .flat_map(|i| {
                    let s = f64::from(i) / 150.0 - 1.0;
                    let head = if s > 0.9 { 0.8 } else { 0.0 };
                    [Point3::new(along * s, 0.0, head), Point3::new(0.0, across * s, 0.0)]
                })
                .collect()
        };
        let distance = |across: f64| {
            align_forms(&prepared(&cross(4.0, across)), &prepared(&cross(across, 4.0)), Reflections::Allow)
                .rms
        };
        assert!(distance(4.4) < 0.7 * distance(5.0), "spreads that differ by 10 % and by 25 %");
    }
}
