//! Intersections between the limbs of a posed body.

use nalgebra::Point3;

use crate::pose::{PosedSkeleton, axis_point};
use crate::skeleton::{Chain, Skeleton};

/// Balls along every chain that approximate the limb.
const N_BALLS: usize = 24;
/// Smallest distance of two balls as a share of the sum of their radii: flesh is soft, and trunks are flatter
/// than the balls in them.
const SOFTNESS: f64 = 0.8;
/// Balls that are closer along the bones than this multiple of the sum of their radii belong to the same bend
/// and may touch.
const BEND: f64 = 2.5;

/// A ball around a point of a chain's axis.
struct Ball {
    chain: usize,
    arc: f64,
    radius: f64,
    rest: Point3<f64>,
    posed: Point3<f64>,
}

/// The largest depth to which two limbs intersect, as a share of their thickness there; zero or less if none do.
///
/// Limbs are approximated by balls along the bones. A pair of balls counts if the balls are separate in the rest pose
/// and do not belong to the same bend. The cost is quadratic in the number of balls, well under a millisecond.
pub(crate) fn entanglement(posed: &PosedSkeleton<'_>) -> f64 {
    let skeleton = posed.skeleton;
    let balls: Vec<Ball> = (0..skeleton.chains.len()).flat_map(|chain| balls(posed, chain)).collect();
    let mut worst = f64::NEG_INFINITY;
    for (i, a) in balls.iter().enumerate() {
        for b in &balls[..i] {
            let sum = a.radius + b.radius;
            let depth = SOFTNESS - (a.posed - b.posed).norm() / sum;
            if depth > worst
                && (a.rest - b.rest).norm() > sum
                && path_length(skeleton, (a.chain, a.arc), (b.chain, b.arc)) > BEND * sum
            {
                worst = depth;
            }
        }
    }
    worst
}

fn balls<'a>(posed: &'a PosedSkeleton<'_>, chain: usize) -> impl Iterator<Item = Ball> + 'a {
    let bones = &posed.skeleton.chains[chain];
    (0..N_BALLS).map(move |i| {
        let arc = bones.length() * (i as f64 + 0.5) / N_BALLS as f64;
        let (rest, posed) = (axis_point(bones, arc), posed.axis_point(chain, arc));
        Ball { chain, arc, radius: radius(bones, arc), rest, posed }
    })
}

/// The radius of a chain at a length along its axis, interpolated between its nodes.
fn radius(bones: &Chain, arc: f64) -> f64 {
    let (i, t) = bones.bone_at(arc);
    bones.nodes[i].radius + (bones.nodes[i + 1].radius - bones.nodes[i].radius) * t
}

/// Length of the path along the bones between two places, each given by a chain and a length along it.
fn path_length(skeleton: &Skeleton, mut a: (usize, f64), mut b: (usize, f64)) -> f64 {
    let mut climbed = 0.0;
    while a.0 != b.0 {
        // Parents come first, so the later chain is the one to leave.
        let lower = if a.0 > b.0 { &mut a } else { &mut b };
        let Some(parent) = skeleton.chains[lower.0].parent else {
            return f64::INFINITY;
        };
        climbed += lower.1;
        *lower = parent;
    }
    climbed + (a.1 - b.1).abs()
}
