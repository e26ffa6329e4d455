//! Rigid alignment of two point sets, and the distance between them.

use nalgebra::{Point3, Vector3};

use crate::icp::{Alignment, Body, Effort, Towards, refine};
use crate::nearest::NearestPoints;
use crate::point_set::PointSet;
use crate::similarity::Similarity;
use crate::starts::axis_motions;

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

/// For all starts: enough steps to rank them, since their order before the first step says little about the order at the
/// end. Limits of effort, as are the other two.
pub(crate) const SKETCH: Effort = Effort { samples: 50, steps: 4, towards: Towards::Points };

/// For the best [`REFINED`] starts.
const ROUGH: Effort = Effort { samples: 100, steps: 20, towards: Towards::Points };

/// For the very best.
pub(crate) const FINE: Effort = Effort { samples: PointSet::SAMPLES, steps: 30, towards: Towards::Points };

const REFINED: usize = 8;

/// A start whose sketch is beyond this multiple of the best refined error will not come below it. A safety limit.
const ABANDON_FACTOR: f64 = 2.0;

/// A point set of which some points are searched.
struct View<'a> {
    samples: &'a [Point3<f64>],
    searched: &'a NearestPoints,
}

impl Body for View<'_> {
    fn samples(&self) -> &[Point3<f64>] {
        self.samples
    }

    #[inline]
    fn nearest(
        &self,
        query: &Point3<f64>,
        _known: Option<&Point3<f64>>,
    ) -> Option<(Point3<f64>, Vector3<f64>)> {
        Some((self.searched.points()[self.searched.nearest(query).0], Vector3::zeros()))
    }
}

/// Two sets, either by its samples alone or by all points.
fn views<'a>(sets: [&'a PointSet; 2], searched: fn(&PointSet) -> &NearestPoints) -> [View<'a>; 2] {
    sets.map(|set| View { samples: set.samples().points(), searched: searched(set) })
}

/// Aligns two point sets rigidly and measures the distance between them.
///
/// * The principal axes of both are brought onto each other under all signs, and with near-equal axes exchanged: 8 to 48 starts,
///   half of them without reflections, ranked by a few steps on a coarse sample.
/// * The best starts are refined on a coarse sample by iterative closest points, and the best of these on all
///   samples. Pairs are taken in both directions, so neither set is favored; samples are spread evenly and count the
///   same, so the density of points does not matter; each step solves Kabsch's problem and keeps the handedness of its
///   start.
/// * The distance is symmetric up to the local minimum in which the refinement ends.
///
/// ```
/// use canonform_rigid::{PointSet, Reflections, align_points};
/// use nalgebra::Point3;
///
/// let spiral = |turn: f64| {
///     let at = |i: i32| Point3::new(f64::from(i - 50), (turn + 0.1 * f64::from(i)).sin(), (turn + 0.1 * f64::from(i)).cos());
///     PointSet::new(&(0..=100).map(at).collect::<Vec<_>>(), &[1.0 / 101.0; 101])
/// };
/// let found = align_points(&spiral(0.0)?, &spiral(2.0)?, Reflections::Allow);
/// assert!(found.gap.rms < 0.1, "one is the other, turned about its axis");
/// # Ok::<(), canonform_rigid::NoExtent>(())
/// ```
pub fn align_points(a: &PointSet, b: &PointSet, reflections: Reflections) -> Alignment {
    let mut best = (f64::INFINITY, Similarity::identity());
    let [rough_a, rough_b] = views([a, b], PointSet::samples);
    for (error, start) in sketched(a, b, reflections) {
        if error > ABANDON_FACTOR * best.0 {
            break;
        }
        let refined = refine(&rough_a, &rough_b, start, ROUGH);
        if refined.rms() < best.0 {
            best = (refined.rms(), refined.map);
        }
    }
    let [fine_a, fine_b] = views([a, b], PointSet::all);
    let found = refine(&fine_a, &fine_b, best.1, FINE).measured(&fine_a, &fine_b, f64::INFINITY);
    let Some(Alignment { map, gap }) = found else { unreachable!("sets have points") };
    Alignment { map: b.to_principal.inverse().after(&map).after(&a.to_principal), gap }
}

/// Motions of the principal axes of the first set to those of the second, the best of each handedness, after all stages
/// but the last; by ascending error.
pub fn alignments(a: &PointSet, b: &PointSet) -> Vec<Similarity> {
    let sketched = [Reflections::Forbid, Reflections::Require].into_iter().flat_map(|by| sketched(a, b, by));
    refine_all(a, b, sketched.map(|(_, motion)| motion), ROUGH)
        .into_iter()
        .map(|(_, motion)| motion)
        .collect()
}

/// The best starts after a few steps, by ascending error.
fn sketched(a: &PointSet, b: &PointSet, reflections: Reflections) -> Vec<(f64, Similarity)> {
    // Principal axes may be left-handed: then a motion between them reflects if the motion in space does not.
    let flipped = a.to_principal.reflected != b.to_principal.reflected;
    let is_allowed = |motion: &Similarity| match reflections {
        Reflections::Allow => true,
        Reflections::Forbid => motion.reflected == flipped,
        Reflections::Require => motion.reflected != flipped,
    };
    let starts = axis_motions(a.axis_std, b.axis_std).into_iter().filter(is_allowed);
    let mut found = refine_all(a, b, starts, SKETCH);
    found.truncate(REFINED);
    found
}

/// All starts, refined, by ascending error.
fn refine_all(
    a: &PointSet,
    b: &PointSet,
    starts: impl Iterator<Item = Similarity>,
    effort: Effort,
) -> Vec<(f64, Similarity)> {
    let [a, b] = views([a, b], PointSet::samples);
    let refined = starts.map(|start| refine(&a, &b, start, effort));
    let mut found: Vec<_> = refined.map(|refined| (refined.rms(), refined.map)).collect();
    found.sort_by(|x, y| x.0.total_cmp(&y.0));
    found
}
