//! Measuring the noise of points, and smoothing it away.

use budget::{Budget, Exceeded};
use nalgebra::Point3;
use rayon::prelude::*;

use super::fit::patch;
use super::neighbors::Neighbors;

/// Numbers of points of patches that are tried, from small to large.
const SIZES: [usize; 12] = [12, 17, 24, 34, 48, 68, 96, 136, 192, 272, 384, 544];

/// Points at which the noise is measured.
const PROBES: usize = 400;

/// A patch is flat if the points stick out of it by less than this share of its radius.
const FLAT: f64 = 0.14;

/// Points that stick out by less than this share of their spacing are left where they are.
const SLIGHT: f64 = 0.1;

/// Fewest points of a patch that smooths: with fewer, the six coefficients of a quadric follow the noise.
const LEAST: usize = 48;

/// Projections of every point.
const ROUNDS: usize = 3;

/// Points, smoothed if they are noisy.
pub(super) struct Smooth {
    pub(super) points: Vec<Point3<f64>>,
    pub(super) spacing: f64,
    pub(super) noise: f64,
    /// Points of a patch; 0 if nothing was smoothed.
    pub(super) neighbors: usize,
}

/// Smooths points that are noisy.
pub(super) fn smooth(points: Vec<Point3<f64>>, budget: &Budget) -> Result<Smooth, Exceeded> {
    let neighbors = Neighbors::new(&points);
    let found = measure(&points, &neighbors);
    let mut smooth = Smooth { spacing: found.spacing, noise: found.noise, neighbors: 0, points };
    if found.noise < SLIGHT * found.spacing {
        return Ok(smooth);
    }
    let size = found.size.max(LEAST);
    smooth.neighbors = size;
    let rough = smooth.points.clone();
    for _ in 0..ROUNDS {
        budget.check()?;
        let project = |p: &Point3<f64>| {
            let near = neighbors.nearest(p, size);
            let near: Vec<Point3<f64>> = near.iter().map(|(i, _)| rough[*i as usize]).collect();
            patch(p, &near).map_or(*p, |patch| patch.foot)
        };
        smooth.points = smooth.points.par_iter().map(project).collect();
    }
    Ok(smooth)
}

/// What patches of the smallest size that is flat say about points.
struct Measured {
    size: usize,
    noise: f64,
    spacing: f64,
}

fn measure(points: &[Point3<f64>], neighbors: &Neighbors) -> Measured {
    // Spread over the input by the golden ratio: neighbours in the input are often neighbours in space.
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let n = points.len();
    let probe = |i: usize| ((i as f64 * GOLDEN).fract() * n as f64) as usize;
    let probes: Vec<Point3<f64>> = (0..PROBES.min(n)).map(|i| points[probe(i).min(n - 1)]).collect();
    let largest = SIZES.iter().rposition(|size| *size <= n / 8).unwrap_or(0);
    let mut measured = Measured { size: SIZES[0], noise: 0.0, spacing: 0.0 };
    for &size in &SIZES[..=largest] {
        let of_probe = |p: &Point3<f64>| {
            let near = neighbors.nearest(p, size);
            let radius = near.last().map_or(0.0, |(_, sq)| sq.sqrt());
            let near: Vec<Point3<f64>> = near.iter().map(|(i, _)| points[*i as usize]).collect();
            (patch(p, &near).map_or(0.0, |patch| patch.residual), radius)
        };
        let (mut residuals, mut radii): (Vec<f64>, Vec<f64>) = probes.par_iter().map(of_probe).unzip();
        let (noise, radius) = (median(&mut residuals), median(&mut radii));
        // The disc of the patch shared among its points.
        let spacing = radius * (std::f64::consts::PI / size as f64).sqrt();
        measured = Measured { size, noise, spacing };
        if noise <= FLAT * radius {
            break;
        }
    }
    measured
}

fn median(values: &mut [f64]) -> f64 {
    match values.len() {
        0 => 0.0,
        n => *values.select_nth_unstable_by(n / 2, f64::total_cmp).1,
    }
}
