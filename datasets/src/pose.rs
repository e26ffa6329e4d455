//! Bending a body: from turns of joints to positions of points.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::skeleton::{Chain, Skeleton};
use crate::stream::Stream;
use crate::trig::rotation;

/// A rotation of a joint about its x, y and z axes in degrees: about y first, then x, then z. It is mirrored for the right
/// side, so that the same numbers give the mirror image.
pub(crate) type JointTurn = [f64; 3];

/// The turns of all joints of one skeleton.
#[derive(Debug, Clone)]
pub(crate) struct Pose {
    /// Rotation of the whole body about its first node.
    pub(crate) root: JointTurn,
    /// Per chain, one for each of its joints.
    pub(crate) turns: Vec<Vec<JointTurn>>,
}

impl Pose {
    /// The rest pose.
    pub(crate) fn rest(skeleton: &Skeleton) -> Self {
        let turns = skeleton.chains.iter().map(|c| vec![JointTurn::default(); c.joints.len()]).collect();
        Self { root: JointTurn::default(), turns }
    }

    /// A random variation: every turn is scaled by up to 15 %, the play of every joint is added, and half of
    /// the time left and right are exchanged.
    pub(crate) fn varied(&self, skeleton: &Skeleton, stream: &mut Stream) -> Self {
        let mut pose = self.clone();
        for (chain, turns) in skeleton.chains.iter().zip(&mut pose.turns) {
            for (joint, turn) in chain.joints.iter().zip(turns) {
                let vigour = stream.uniform(0.85, 1.15);
                let [x, y, z] = joint.play.map(|play| stream.uniform(-play, play));
                *turn = [turn[0] * vigour + x, turn[1] * vigour + y, turn[2] * vigour + z];
            }
        }
        if stream.uniform(0.0, 1.0) < 0.5 { pose.mirrored(skeleton) } else { pose }
    }

    fn mirrored(&self, skeleton: &Skeleton) -> Self {
        let flip = |[x, y, z]: JointTurn| [x, -y, -z];
        let mut pose = self.clone();
        pose.root = flip(self.root);
        for (c, chain) in skeleton.chains.iter().enumerate() {
            if chain.is_mirrored {
                pose.turns.swap(c - 1, c);
            } else if skeleton.chains.get(c + 1).is_none_or(|next| !next.is_mirrored) {
                pose.turns[c].iter_mut().for_each(|t| *t = flip(*t));
            }
        }
        pose
    }
}

/// Half the range of the factors of lengths and of girths, which are uniform. Their standard deviations, 4 % and 9 %,
/// are roughly those of statures and of the girths of trunk and limbs among adults.
const VARIATION: [f64; 2] = [0.07, 0.16];

/// Random factors of the length and of the girth of every chain, relative to what the skeleton describes; the same on the left
/// and on the right.
pub(crate) fn random_build(skeleton: &Skeleton, stream: &mut Stream) -> Vec<[f64; 2]> {
    let mut factors: Vec<[f64; 2]> = Vec::with_capacity(skeleton.chains.len());
    for chain in &skeleton.chains {
        let drawn = match factors.last() {
            Some(left) if chain.is_mirrored => *left,
            _ => VARIATION.map(|range| 1.0 + stream.uniform(-range, range)),
        };
        factors.push(drawn);
    }
    factors
}

/// An affine map of space; a rigid motion unless the body has other proportions than the skeleton.
#[derive(Debug, Clone, Copy)]
struct Motion {
    rotation: Matrix3<f64>,
    shift: Vector3<f64>,
}

impl Motion {
    fn apply(&self, p: Point3<f64>) -> Point3<f64> {
        Point3::from(self.rotation * p.coords + self.shift)
    }
}

/// A skeleton bent into a pose: a rigid motion for every place along every chain.
#[derive(Debug, Clone)]
pub(crate) struct PosedSkeleton<'a> {
    /// The skeleton at rest.
    pub(crate) skeleton: &'a Skeleton,
    /// Motions at equal steps along each chain.
    motions: Vec<Vec<Motion>>,
}

/// Steps along a chain. Between them, motions are interpolated linearly. The sharpest bends turn by five
/// degrees per step, where this shortens lengths by 1e-3.
const N_STEPS: usize = 256;

impl<'a> PosedSkeleton<'a> {
    /// Bends the skeleton.
    pub(crate) fn new(skeleton: &'a Skeleton, pose: &Pose) -> Self {
        let mut motions: Vec<Vec<Motion>> = Vec::with_capacity(skeleton.chains.len());
        for (chain, turns) in skeleton.chains.iter().zip(&pose.turns) {
            let base = match chain.parent {
                Some(place) => interpolate(skeleton, &motions, place),
                None => {
                    let [x, y, z] = pose.root;
                    let rotation = rotation(x, y, z);
                    let pivot = chain.nodes[0].at.coords;
                    Motion { rotation, shift: pivot - rotation * pivot }
                }
            };
            motions.push(bend(chain, turns, base));
        }
        Self { skeleton, motions }
    }

    /// The same pose of a body with other proportions: the axis of every chain is lengthened, everything is moved away
    /// from its axis, and children stay where they are attached.
    pub(crate) fn built(self, build: &[[f64; 2]]) -> Self {
        let mut motions: Vec<Vec<Motion>> = Vec::with_capacity(self.motions.len());
        let chains = self.skeleton.chains.iter().zip(&self.motions).zip(build);
        for ((chain, plain), &[length, girth]) in chains {
            let start = axis_point(chain, 0.0);
            let posed = plain[0].apply(start);
            let moved =
                chain.parent.map_or(posed, |place| interpolate(self.skeleton, &motions, place).apply(start));
            let at = |(i, motion): (usize, &Motion)| {
                let axis = axis_point(chain, chain.length() * i as f64 / N_STEPS as f64);
                let rotation = motion.rotation * girth;
                let shift = moved + (motion.apply(axis) - posed) * length - rotation * axis.coords;
                Motion { rotation, shift: shift.coords }
            };
            motions.push(plain.iter().enumerate().map(at).collect());
        }
        Self { motions, ..self }
    }

    /// The posed point of a chain's axis at length `arc`.
    pub(crate) fn axis_point(&self, chain: usize, arc: f64) -> Point3<f64> {
        let point = axis_point(&self.skeleton.chains[chain], arc);
        interpolate(self.skeleton, &self.motions, (chain, arc)).apply(point)
    }

    /// The posed position of the point `p` of the body at rest.
    pub(crate) fn deform(&self, p: Point3<f64>) -> Point3<f64> {
        let mut sum = Vector3::zeros();
        let mut total = 0.0;
        for (c, member) in self.skeleton.memberships(p).enumerate() {
            let motion = interpolate(self.skeleton, &self.motions, (c, member.arc));
            sum += motion.apply(p).coords * member.weight;
            total += member.weight;
        }
        Point3::from(sum / total)
    }
}

/// The motion of a chain at a length along it.
fn interpolate(skeleton: &Skeleton, motions: &[Vec<Motion>], (chain, arc): (usize, f64)) -> Motion {
    let fraction = arc / skeleton.chains[chain].length();
    let step = (fraction * N_STEPS as f64).clamp(0.0, N_STEPS as f64);
    let i = (step as usize).min(N_STEPS - 1);
    let t = step - i as f64;
    let (a, b) = (motions[chain][i], motions[chain][i + 1]);
    Motion { rotation: a.rotation * (1.0 - t) + b.rotation * t, shift: a.shift * (1.0 - t) + b.shift * t }
}

/// Motions along a chain whose start moves by `base`.
///
/// The rotation at arc length `s` is that of the base, followed by the turn of every joint times the share of the
/// joint's interval before `s`. The axis is the integral of the rotated rest axis, which keeps its length exactly.
fn bend(chain: &Chain, turns: &[JointTurn], base: Motion) -> Vec<Motion> {
    let mirror = if chain.is_mirrored { -1.0 } else { 1.0 };
    let reflect = Matrix3::from_diagonal(&Vector3::new(mirror, 1.0, 1.0));
    let rotation_at = |arc: f64| {
        chain.joints.iter().zip(turns).fold(base.rotation, |product, (joint, [x, y, z])| {
            let middle = chain.arcs[joint.node];
            let share = smooth_step((arc - (middle - joint.before)) / (joint.before + joint.after));
            let turned = joint.frame * rotation(x * share, y * share, z * share) * joint.frame.transpose();
            product * (reflect * turned * reflect)
        })
    };
    let step = chain.length() / N_STEPS as f64;
    let mut axis = axis_point(chain, 0.0);
    let mut moved = base.apply(axis).coords;
    let mut motions = Vec::with_capacity(N_STEPS + 1);
    for i in 0..=N_STEPS {
        let arc = step * i as f64;
        if i > 0 {
            let following = axis_point(chain, arc);
            moved += rotation_at(arc - 0.5 * step) * (following - axis);
            axis = following;
        }
        let rotation = rotation_at(arc);
        motions.push(Motion { rotation, shift: moved - rotation * axis.coords });
    }
    motions
}

/// Rises from zero to one for `t` in 0..=1, with zero slope at both ends.
fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// The point of a chain's axis at length `arc`, at rest.
pub(crate) fn axis_point(chain: &Chain, arc: f64) -> Point3<f64> {
    let (i, t) = chain.bone_at(arc);
    chain.nodes[i].at + (chain.nodes[i + 1].at - chain.nodes[i].at) * t
}
