//! Alignment of two surfaces in space, by the best motion, reflection and change of size.

use crate::align_points::{self, Reflections, SKETCH, align_points};
use crate::handedness::is_decisive;
use crate::icp::{Alignment, Effort, Gap, Refined, Towards, contacts, refine};
use crate::rigid_surface::{RigidSurface, rms_radius};
use crate::similarity::Similarity;
use crate::starts::{equal_axes, framed_starts, mirrors, turned_starts};

/// Surfaces of one size whose deviations along a principal axis differ by more than this share of their rms radius are not
/// aligned: they are farther apart than any copy of a surface (`cargo test -p tests --test laws matches`).
pub const MAX_DEVIATION: f64 = 0.05;

/// As much effort as for points.
const FINE: Effort = Effort { towards: Towards::Planes, ..align_points::FINE };

/// Bodies are not aligned further if points of them, at unit rms radius, stay farther apart than this, unless they may be turned about
/// their axes: twice what copies of built-in shapes with 1,000 to 10,000 vertices leave
/// (`cargo test -p tests --test laws matches`).
const FAR: f64 = 0.1;

/// Turned starts are tried unless the surfaces are nearer than this, relative to the size. A safety limit: other bodies are at
/// least 0.0045 apart (`cargo test -p tests --test laws matches`).
const CLOSE: f64 = 0.003;

/// Mechanical parts that are nearer than this are aligned: their planes coincide. A tolerance of rounding.
const COINCIDENT_RMS: f64 = 1e-5;

/// The least difference of two root mean square distances that tells: those at which the refinement of copies ends.
const RESOLUTION: f64 = 1e-4;

/// Turned starts that are refined: the best by as many samples as a sketch has. Limits of effort.
const RANKED: usize = 4;

/// An alignment of the samples is refined unless the other handedness is better by this factor, and one that is refined counts
/// unless the best is better by it. A safety limit: it saves time.
const REFINE_WITHIN: f64 = 1.6;

/// The largest difference of the deviations of two surfaces along their principal axes, each as a share of its rms radius.
pub fn axis_deviation(a: [f64; 3], b: [f64; 3]) -> f64 {
    let [a, b] = [a, b].map(|axis_std| axis_std.map(|x| x / rms_radius(axis_std)));
    a.iter().zip(&b).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max)
}

/// Aligns two surfaces in space; `None` if they are too far apart to be one surface, by their extents or by a few points. The map
/// takes the first surface, at unit area, onto the second, at unit area: with a reflection only if the surfaces fit decisively
/// better.
pub fn align_surfaces(a: &RigidSurface, b: &RigidSurface) -> Option<Alignment> {
    if axis_deviation(a.axis_std, b.axis_std) > MAX_DEVIATION {
        return None;
    }
    let start = |by| Some(align_points(a.points()?, b.points()?, by));
    let [proper, reflected] = [start(Reflections::Forbid)?, start(Reflections::Require)?];
    let turnable = equal_axes(a.axis_std, b.axis_std) != [false; 2];
    let are_bodies = !(a.is_mechanical() && b.is_mechanical());
    if are_bodies && !turnable && f64::min(proper.gap.rms, reflected.gap.rms) > FAR {
        return None;
    }
    let found = |mine: Alignment, other: Alignment| {
        let is_worth = turnable || mine.gap.rms < REFINE_WITHIN * other.gap.rms;
        if is_worth { best(a, b, &mine.map) } else { None }
    };
    let proper_found = found(proper, reflected);
    // No reflection is decisively better than a map that is as good as refinement ends.
    let is_found = proper_found.is_some_and(|found| found.gap.rms <= RESOLUTION);
    let reflected_found = if is_found { None } else { found(reflected, proper) };
    match (proper_found, reflected_found) {
        (Some(proper), Some(reflected)) if !is_better(&reflected, &proper) => Some(proper),
        (_, Some(reflected)) => Some(unmirrored(a, b, &reflected).unwrap_or(reflected)),
        (proper, None) => proper,
    }
}

impl Alignment {
    /// Two surfaces under a map of the first, at unit area, onto the second; `None` of surfaces without area.
    pub fn by_map(a: &RigidSurface, b: &RigidSurface, map: Similarity) -> Option<Self> {
        Refined { map, near: Vec::new(), samples: 0 }.measured(a, b, f64::INFINITY)
    }
}

fn is_better(better: &Alignment, worse: &Alignment) -> bool {
    is_decisive(better.gap.rms, worse.gap.rms, RESOLUTION)
}

/// The alignment without a reflection that is as good as one with a reflection, if the surface is its own mirror image.
fn unmirrored(a: &RigidSurface, b: &RigidSurface, mirrored: &Alignment) -> Option<Alignment> {
    nearest_starts(a, b, mirrors(b).map(|mirror| mirror.after(&mirrored.map))).into_iter().find_map(|start| {
        let found = refine(a, b, start, FINE).measured(a, b, f64::INFINITY)?;
        (!is_better(mirrored, &found)).then_some(found)
    })
}

/// Whether a surface is its own mirror image.
pub fn is_symmetric(surface: &RigidSurface) -> bool {
    let itself = Alignment { map: Similarity::identity(), gap: Gap { rms: 0.0, max: 0.0 } };
    let is_near = |mirror: &Similarity| {
        let squares =
            contacts(surface, surface, mirror, 0..SKETCH.samples, &[]).map(|contact| contact.sq_distance());
        squares.sum::<f64>() < 2.0 * SKETCH.samples as f64 * CLOSE * CLOSE
    };
    mirrors(surface).filter(is_near).any(|mirror| {
        let found = refine(surface, surface, mirror, FINE).measured(surface, surface, f64::INFINITY);
        found.is_some_and(|found| !is_better(&itself, &found))
    })
}

/// The best alignment from a motion between the samples, with a reflection if and only if that has one.
fn best(a: &RigidSurface, b: &RigidSurface, start: &Similarity) -> Option<Alignment> {
    // The samples have unit rms radius.
    let [radius_a, radius_b] = [a, b].map(RigidSurface::rms_radius);
    let scaled = |motion: Similarity| Similarity {
        translation: motion.translation * radius_b,
        scale: radius_b / radius_a,
        ..motion
    };
    let mut best = refine(a, b, scaled(*start), FINE).measured(a, b, f64::INFINITY)?;
    let is_mechanical = a.is_mechanical() && b.is_mechanical();
    if best.gap.rms < if is_mechanical { COINCIDENT_RMS } else { CLOSE } {
        return Some(best);
    }
    let equal = equal_axes(a.axis_std, b.axis_std);
    let mut turned = turned_starts(equal, &b.principal_axes()?, start);
    if is_mechanical {
        turned.extend(framed_starts(a, b, start.reflected));
    }
    for start in nearest_starts(a, b, turned.into_iter().map(scaled)) {
        let refined = refine(a, b, start, FINE);
        if refined.rms() > REFINE_WITHIN * best.gap.rms {
            continue;
        }
        let found = refined.measured(a, b, best.gap.rms).filter(|found| found.gap.rms < best.gap.rms);
        best = found.unwrap_or(best);
        if best.gap.rms < COINCIDENT_RMS {
            break;
        }
    }
    Some(best)
}

/// The [`RANKED`] starts that bring few samples nearest to the other surface, in this order.
fn nearest_starts(
    a: &RigidSurface,
    b: &RigidSurface,
    starts: impl Iterator<Item = Similarity>,
) -> Vec<Similarity> {
    let mut ranked: Vec<(f64, Similarity)> = Vec::with_capacity(RANKED + 1);
    for start in starts {
        let most = ranked.get(RANKED - 1).map_or(f64::INFINITY, |last| last.0);
        let mut sum = 0.0;
        // The sum only grows, so most starts are left early.
        let is_near = contacts(a, b, &start, 0..SKETCH.samples, &[]).all(|contact| {
            sum += contact.sq_distance();
            sum < most
        });
        if is_near {
            ranked.insert(ranked.partition_point(|other| other.0 <= sum), (sum, start));
            ranked.truncate(RANKED);
        }
    }
    ranked.into_iter().map(|(_, start)| start).collect()
}
