//! Measuring the noise of points, and smoothing it away.

use base::{Budget, Exceeded};
use nalgebra::Point3;
use rayon::prelude::*;

use super::fit::patch;
use crate::box_tree::BoxTree;

/// Points of the patches that tell whether there is noise.
const FEW: usize = 12;

/// Numbers of points of patches that measure the noise, from small to large. With fewer, the six coefficients of a quadric
/// follow the noise.
const SIZES: [usize; 8] = [48, 68, 96, 136, 192, 272, 384, 544];

/// Points at which the noise is measured.
const PROBES: usize = 400;

/// A patch is flat if the points stick out of it by less than this share of its radius.
const FLAT: f64 = 0.14;

/// Points that stick out by less than this share of their spacing are left where they are.
const SLIGHT: f64 = 0.1;

/// Radius of the smallest patch that smooths, in standard deviations of the noise.
const REACH: f64 = 3.0;

/// Radius that no larger patch exceeds, in standard deviations of the noise.
const FARTHEST: f64 = 8.0;

/// Growth of a patch from one size to the next that is tried.
const STEP: f64 = std::f64::consts::SQRT_2;

/// Steps by which a patch may grow.
const STEPS: usize = 4;

/// Points stick out of a patch that fits by at most this multiple of the noise.
const FITS: f64 = 1.1;

/// Projections of every point onto patches of the points as they were measured.
const ROUNDS: usize = 3;

/// Projections of every point onto patches of smoothed points, for noise as large as the spacing; as many fewer as noise is
/// smaller.
const EVENING: f64 = 3.5;

/// Most projections onto patches of smoothed points.
const EVENING_ROUNDS: usize = 3;

/// Points, smoothed if they are noisy.
pub(super) struct Smooth {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) spacing: f64,
    pub(super) noise: f64,
    /// Points of the smallest patches; 0 if nothing was smoothed.
    pub(super) neighbors: usize,
}

impl Smooth {
    /// Number of points in a disc whose radius is a multiple of the noise.
    fn in_disc(&self, radius: f64) -> usize {
        (std::f64::consts::PI * (radius * self.noise / self.spacing).powi(2)) as usize
    }
}

/// Smooths points that are noisy.
///
/// A point is projected onto the largest patch that fits within the noise: thin limbs have small patches, which do not shorten
/// them, and flat parts have large ones, over which more noise is averaged. Patches of neighbors of different sizes leave
/// the result uneven, so smoothed points are projected again, onto small patches of each other.
pub(super) fn smooth(points: Vec<Point3<f64>>, budget: &Budget) -> Result<Smooth, Exceeded> {
    let neighbors = BoxTree::new(points.iter().copied().zip(0..));
    let at = probes(&points);
    let [noise, _, spacing] = residuals(&points, &neighbors, &at, FEW, 0.5);
    let mut smooth = Smooth { spacing, noise, neighbors: 0, points };
    if noise < SLIGHT * spacing {
        return Ok(smooth);
    }
    (smooth.noise, smooth.spacing) = measure(&smooth.points, &neighbors, &at);
    smooth.neighbors = smooth.in_disc(REACH).clamp(SIZES[0], SIZES[SIZES.len() - 1]);
    budget.check()?;
    let sizes = sizes(&smooth, &neighbors);
    let rough = smooth.points.clone();
    for _ in 0..ROUNDS {
        budget.check()?;
        let project = |(p, size): (&Point3<f64>, &usize)| foot(p, &neighbors, &rough, *size);
        smooth.points = smooth.points.par_iter().zip(&sizes).map(project).collect();
    }
    let evening = (EVENING * smooth.noise / smooth.spacing) as usize;
    for _ in 0..evening.min(EVENING_ROUNDS) {
        budget.check()?;
        let near = BoxTree::new(smooth.points.iter().copied().zip(0..));
        let project = |p: &Point3<f64>| foot(p, &near, &smooth.points, smooth.neighbors);
        smooth.points = smooth.points.par_iter().map(project).collect();
    }
    Ok(smooth)
}

/// A place, projected onto the patch of this many points around it.
fn foot(place: &Point3<f64>, neighbors: &BoxTree, points: &[Point3<f64>], size: usize) -> Point3<f64> {
    patch(place, &nearest(place, neighbors, points, size)).map_or(*place, |(foot, _)| foot)
}

fn nearest(
    place: &Point3<f64>,
    neighbors: &BoxTree,
    points: &[Point3<f64>],
    size: usize,
) -> Vec<Point3<f64>> {
    neighbors.nearest(place, size).iter().map(|(_, i)| points[*i as usize]).collect()
}

/// For every point, the number of points of the largest patch that fits.
fn sizes(rough: &Smooth, neighbors: &BoxTree) -> Vec<usize> {
    let most = rough.in_disc(FARTHEST).min(rough.points.len() / 8);
    let tried: Vec<usize> = (0..=STEPS)
        .map(|step| (rough.neighbors as f64 * STEP.powi(step as i32)) as usize)
        .take_while(|size| *size <= most.max(rough.neighbors))
        .collect();
    let largest = tried[tried.len() - 1];
    let choose = |p: &Point3<f64>| {
        let near = nearest(p, neighbors, &rough.points, largest);
        let fits = |size: &&usize| {
            let patch = patch(p, &near[..(**size).min(near.len())]);
            patch.is_some_and(|(_, residual)| residual <= FITS * rough.noise)
        };
        tried[1..].iter().take_while(fits).last().copied().unwrap_or(rough.neighbors)
    };
    rough.points.par_iter().map(choose).collect()
}

/// Points at which the noise is measured.
fn probes(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    // Spread over the input by the golden ratio: neighbors in the input are often neighbors in space.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let n = points.len();
    let probe = |i: usize| ((i as f64 * GOLDEN).fract() * n as f64) as usize;
    (0..PROBES.min(n)).map(|i| points[probe(i).min(n - 1)]).collect()
}

/// What patches of one size say about points: how far a share of the points stick out of theirs at most, the median
/// radius of the patches, and the distance between points if the disc of a patch is shared evenly.
fn residuals(
    points: &[Point3<f64>],
    neighbors: &BoxTree,
    probes: &[Point3<f64>],
    size: usize,
    share: f64,
) -> [f64; 3] {
    let of_probe = |p: &Point3<f64>| {
        let near = nearest(p, neighbors, points, size);
        let radius = near.last().map_or(0.0, |last| (last - p).norm());
        (patch(p, &near).map_or(0.0, |(_, residual)| residual), radius)
    };
    let (mut residuals, mut radii): (Vec<f64>, Vec<f64>) = probes.par_iter().map(of_probe).unzip();
    let [residual, radius] = [quantile(&mut residuals, share), quantile(&mut radii, 0.5)];
    [residual, radius, radius * (std::f64::consts::PI / size as f64).sqrt()]
}

/// The noise and the spacing of points: those of the smallest patches of which a quarter are flat. Where the surface is
/// more curved, points stick out of large patches without noise.
fn measure(points: &[Point3<f64>], neighbors: &BoxTree, probes: &[Point3<f64>]) -> (f64, f64) {
    let largest = SIZES.iter().rposition(|size| *size <= points.len() / 8).unwrap_or(0);
    let mut measured = (0.0, 0.0);
    for &size in &SIZES[..=largest] {
        let [noise, radius, spacing] = residuals(points, neighbors, probes, size, 0.25);
        measured = (noise, spacing);
        if noise <= FLAT * radius {
            break;
        }
    }
    measured
}

fn quantile(values: &mut [f64], share: f64) -> f64 {
    match values.len() {
        0 => 0.0,
        n => *values.select_nth_unstable_by((share * n as f64) as usize, f64::total_cmp).1,
    }
}
