//! Rigid alignment of two forms, and the distance between aligned forms.

use nalgebra::{Matrix3, Point3};

use crate::alignment::Alignment;
use crate::error::DescriptorError;
use crate::prepared::Detail;
use crate::prepared::PreparedForm;

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

/// Whether an alignment may reflect.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Reflections {
    /// It may: distances determine a form only up to reflection.
    #[default]
    Allow,
    /// It must not.
    Forbid,
    /// It must.
    Require,
}

/// Options of [`match_forms`].
#[derive(Debug, Clone, PartialEq)]
pub struct MatchOptions {
    /// The distance that is reported. Default: [`FormDistance::NearestNeighborRms`], which every alignment minimises.
    pub distance: FormDistance,
    /// Default: [`Reflections::Allow`].
    pub reflections: Reflections,
    /// Axes whose spreads differ by less than this factor in both forms may be exchanged, since their order is then
    /// arbitrary. Default: 1.15.
    pub near_equal_axes: f64,
    /// Share of the closest pairs that a step of the alignment uses, in (0, 1]. Default: 1, so that the alignment
    /// minimises the root mean square distance.
    pub trim: f64,
    /// Number of hypotheses that are refined until they converge, after a few steps of all of them. Default: 8.
    pub refined: usize,
}

impl Default for MatchOptions {
    fn default() -> Self {
        Self {
            distance: FormDistance::default(),
            reflections: Reflections::default(),
            near_equal_axes: 1.15,
            trim: 1.0,
            refined: 8,
        }
    }
}

impl MatchOptions {
    /// # Errors
    /// [`DescriptorError::BadOption`] names the option, its value and its range.
    pub fn validate(&self) -> Result<(), DescriptorError> {
        let bad = |option, value, range| Err(DescriptorError::BadOption { option, value, range });
        if self.near_equal_axes.is_nan() || self.near_equal_axes < 1.0 {
            return bad("near_equal_axes", self.near_equal_axes, "at least 1");
        }
        if !(self.trim > 0.0 && self.trim <= 1.0) {
            return bad("trim", self.trim, "above 0 and at most 1");
        }
        if self.refined == 0 {
            return bad("refined", 0.0, "at least 1");
        }
        Ok(())
    }
}

/// The best rigid match of two forms.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FormMatch {
    /// Takes the first form, in its own coordinates, onto the second.
    pub alignment: Alignment,
    /// Root mean square distance of the aligned forms, in the unit of the forms.
    pub rms: f64,
    /// The distance that [`MatchOptions::distance`] names, in the same unit.
    pub distance: f64,
}

/// The effort of a stage of the alignment.
#[derive(Debug, Clone, Copy)]
struct Stage {
    /// Samples of either form that are matched.
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

/// An error on the coarse sample beyond this multiple of the limit will not come below the limit.
const HOPELESS: f64 = 2.0;

/// A step that reduces the error by less than this share is the last.
const LEAST_GAIN: f64 = 1e-3;

/// Aligns two canonical forms rigidly and measures the distance between them.
///
/// * The principal axes of both are matched under all signs, and with near-equal axes exchanged: 8 to 48 hypotheses,
///   half of them without reflections, ranked by a few steps on a coarse sample.
/// * The best hypotheses are refined on a coarse sample by (trimmed) iterative closest points, and the best of these
///   on all samples. Pairs are taken in both directions, so neither form is favoured; samples are spread evenly and
///   count the same, so the triangulation does not matter; each step solves Kabsch's problem and keeps the
///   handedness of its hypothesis.
/// * Reflections are allowed by default: distances on a surface do not determine them.
/// * The distance is symmetric up to the local minimum in which the refinement ends.
///
/// ```
/// use canonform_descriptors::{CanonicalForm, MatchOptions, PreparedForm, match_forms};
/// use nalgebra::Point3;
///
/// let spiral = |turn: f64| {
///     let at = |i: i32| Point3::new(f64::from(i), (turn + 0.1 * f64::from(i)).sin(), (turn + 0.1 * f64::from(i)).cos());
///     let form = CanonicalForm::from_points((0..100).map(at).collect(), vec![1.0; 100])?;
///     PreparedForm::new(&form, 50)
/// };
/// let found = match_forms(&spiral(0.0)?, &spiral(2.0)?, &MatchOptions::default())?;
/// assert!(found.rms < 0.1, "one is the other, turned about its axis");
/// # Ok::<(), canonform_descriptors::DescriptorError>(())
/// ```
///
/// # Errors
/// [`DescriptorError::BadOption`].
pub fn match_forms(
    a: &PreparedForm,
    b: &PreparedForm,
    options: &MatchOptions,
) -> Result<FormMatch, DescriptorError> {
    let found = match_forms_within(a, b, options, f64::INFINITY)?;
    found.ok_or(DescriptorError::NoExtent { n_points: a.samples().len() })
}

/// Aligns two forms as [`match_forms`] does, or returns `None` once the root mean square distance turns out to be
/// larger than `limit`.
///
/// * Nothing is aligned if the [lower bound](PreparedForm::least_distance) of the distance is larger.
/// * The alignment stops if after its second stage the error on a coarse sample is more than twice the limit. This
///   is a heuristic: the last stage hardly moves a form any more, and on the built-in dataset no neighbour is lost.
///
/// # Errors
/// [`DescriptorError::BadOption`].
pub fn match_forms_within(
    a: &PreparedForm,
    b: &PreparedForm,
    options: &MatchOptions,
    limit: f64,
) -> Result<Option<FormMatch>, DescriptorError> {
    options.validate()?;
    if a.least_distance(b) > limit {
        return Ok(None);
    }
    let refine_all = |stage, starts: Vec<Alignment>| {
        let refined = starts.into_iter().map(|start| refine(a, b, start, stage, options.trim));
        let mut found: Vec<(f64, Alignment)> = refined.collect();
        found.sort_by(|x, y| x.0.total_cmp(&y.0));
        found
    };
    let motions = |found: Vec<(f64, Alignment)>| found.into_iter().map(|(_, motion)| motion);
    let sketched = refine_all(SKETCH, hypotheses(a, b, options));
    let rough = refine_all(ROUGH, motions(sketched).take(options.refined).collect());
    let (error, start) = rough[0];
    if error > HOPELESS * limit {
        return Ok(None);
    }
    let (_, motion) = refine(a, b, start, FINE, options.trim);
    let found = pairs(a, b, &motion, FINE);
    let sides = found.split_at(a.samples().len());
    let rms = rms(sides);
    let distance = match options.distance {
        FormDistance::NearestNeighborRms => rms,
        FormDistance::Hausdorff95 => hausdorff95(sides),
    };
    let alignment = b.to_principal.inverse().after(&motion).after(&a.to_principal);
    Ok(Some(FormMatch { alignment, rms, distance }).filter(|found| found.rms <= limit))
}

/// Signed permutations of the principal axes that may bring `a` onto `b`.
fn hypotheses(a: &PreparedForm, b: &PreparedForm, options: &MatchOptions) -> Vec<Alignment> {
    const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]];
    let exchangeable = |i: usize, j: usize| {
        let near = |spread: [f64; 3]| spread[i.min(j)] <= options.near_equal_axes * spread[i.max(j)];
        near(a.axis_spread) && near(b.axis_spread)
    };
    // Principal axes may be left-handed: then a motion between them reflects if the motion in space does not.
    let flipped = a.to_principal.reflected != b.to_principal.reflected;
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
            let motion = Alignment::about_origin(matrix);
            let allowed = match options.reflections {
                Reflections::Allow => true,
                Reflections::Forbid => motion.reflected == flipped,
                Reflections::Require => motion.reflected != flipped,
            };
            if allowed {
                motions.push(motion);
            }
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

/// Root mean square of the closest share `trim` of the pairs.
fn error(pairs: &[Pair], trim: f64) -> f64 {
    let kept = share_of(pairs.len(), trim);
    let mut squares: Vec<f64> = pairs.iter().map(|pair| pair.2).collect();
    if kept < squares.len() {
        squares.select_nth_unstable_by(kept, f64::total_cmp);
    }
    (squares[..kept].iter().sum::<f64>() / kept.max(1) as f64).sqrt()
}

fn share_of(n: usize, trim: f64) -> usize {
    ((n as f64 * trim).ceil() as usize).min(n)
}

/// Trimmed iterative closest points from `start`. Returns the best motion and its error.
fn refine(a: &PreparedForm, b: &PreparedForm, start: Alignment, stage: Stage, trim: f64) -> (f64, Alignment) {
    let mut motion = start;
    let mut best = (f64::INFINITY, start);
    for _ in 0..=stage.steps {
        let mut found = pairs(a, b, &motion, stage);
        let error = error(&found, trim);
        let settled = error > best.0 * (1.0 - LEAST_GAIN);
        if error < best.0 {
            best = (error, motion);
        }
        if settled {
            break;
        }
        let kept = share_of(found.len(), trim);
        if kept < found.len() {
            found.select_nth_unstable_by(kept, |x, y| x.2.total_cmp(&y.2));
        }
        let close: Vec<_> = found[..kept].iter().map(|(x, y, _)| (*x, *y)).collect();
        match Alignment::fit(&close, start.reflected) {
            Some(next) => motion = next,
            None => break,
        }
    }
    best
}

/// See [`FormDistance::NearestNeighborRms`].
fn rms((from_a, from_b): (&[Pair], &[Pair])) -> f64 {
    let mean = |side: &[Pair]| side.iter().map(|pair| pair.2).sum::<f64>() / side.len().max(1) as f64;
    (0.5 * (mean(from_a) + mean(from_b))).sqrt()
}

/// See [`FormDistance::Hausdorff95`].
fn hausdorff95((from_a, from_b): (&[Pair], &[Pair])) -> f64 {
    let quantile = |side: &[Pair]| {
        let mut squares: Vec<f64> = side.iter().map(|pair| pair.2).collect();
        let rank = share_of(squares.len(), 0.95).saturating_sub(1);
        *squares.select_nth_unstable_by(rank, f64::total_cmp).1
    };
    quantile(from_a).max(quantile(from_b)).sqrt()
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
        PreparedForm::new(&form, 400).unwrap()
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
            let found = match_forms(
                &prepared(&points),
                &prepared(&turned(&points, mirror)),
                &MatchOptions::default(),
            )
            .unwrap();
            assert!(found.distance < 1e-10, "{}", found.distance);
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
        let by = |reflections, other: &PreparedForm| {
            let options = MatchOptions { reflections, ..Default::default() };
            match_forms(&prepared(&points), other, &options).unwrap()
        };
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
        let options = MatchOptions::default();
        let base = prepared(&figure(600, 1.0));
        let mut last = 0.0;
        for bend in [1.5, 2.5, 4.0] {
            let other = prepared(&figure(500, bend));
            for kind in [FormDistance::NearestNeighborRms, FormDistance::Hausdorff95] {
                let options = MatchOptions { distance: kind, ..options.clone() };
                let there = match_forms(&base, &other, &options).unwrap().distance;
                let back = match_forms(&other, &base, &options).unwrap().distance;
                assert!((there - back).abs() < 0.02 * there, "{there} {back}");
            }
            let distance = match_forms(&base, &other, &options).unwrap().distance;
            assert!(distance > last);
            last = distance;
        }
    }

    #[test]
    fn the_lower_bound_holds_and_far_pairs_are_abandoned() {
        let forms: Vec<_> = [0.2, 1.0, 2.5, 4.0, 9.0].map(|bend| prepared(&figure(500, bend))).into();
        let options = MatchOptions::default();
        let mut bounded = 0;
        for (a, b) in forms.iter().flat_map(|a| forms.iter().map(move |b| (a, b))) {
            let whole = match_forms(a, b, &options).unwrap();
            let least = a.least_distance(b);
            assert!(least <= whole.distance + 1e-12, "{least} {}", whole.distance);
            assert_eq!(least, b.least_distance(a));
            bounded += usize::from(least > 0.1 * whole.distance);
            let within = |limit| match_forms_within(a, b, &options, limit).unwrap();
            assert_eq!(within(f64::INFINITY), Some(whole));
            assert_eq!(within(whole.distance), Some(whole), "at the limit");
            assert_eq!(within(0.9 * whole.distance - 1e-9), None);
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
        let (a, b) = (prepared(&cross(4.0, 4.4)), prepared(&cross(4.4, 4.0)));
        let exchanged = match_forms(&a, &b, &MatchOptions::default()).unwrap().distance;
        let fixed = MatchOptions { near_equal_axes: 1.0, ..Default::default() };
        assert!(exchanged < match_forms(&a, &b, &fixed).unwrap().distance);
    }

    #[test]
    fn options_out_of_range_are_named() {
        let form = prepared(&figure(50, 1.0));
        for (options, name) in [
            (MatchOptions { near_equal_axes: 0.5, ..Default::default() }, "near_equal_axes"),
            (MatchOptions { trim: 0.0, ..Default::default() }, "trim"),
            (MatchOptions { refined: 0, ..Default::default() }, "refined"),
        ] {
            let fault = match_forms(&form, &form, &options).unwrap_err();
            assert!(matches!(fault, DescriptorError::BadOption { option, .. } if option == name));
        }
        let form = CanonicalForm::from_points(figure(50, 1.0), vec![1.0; 50]).unwrap();
        assert!(matches!(PreparedForm::new(&form, 3), Err(DescriptorError::BadOption { .. })));
    }
}
