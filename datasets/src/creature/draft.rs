//! A body under construction: limbs with their bones.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Point3, Vector3};

use crate::implicit::{Blob, BodyPart};
use crate::skeleton::{BoneNode, Joint, Skeleton};
use crate::trig::sin_cos;

/// Greatest product of the angle of a joint in radians and the girth of the limb, over the length that bends. A straight
/// line on the side of a bent limb becomes longer or shorter by up to this share.
const STRAIN: f64 = 0.5;

/// The play of a joint in variations of a pose, relative to the greatest angle of the joint in typical poses.
pub(crate) const PLAY: f64 = 0.2;

/// Blending radius of a limb and the rest of the body, relative to the radius of its root.
const BLEND: f64 = 0.6;

/// Cones of a ring.
const N_SIDES: usize = 18;

/// The tube around a chain of bones.
#[derive(Debug, Clone)]
pub(crate) struct Limb {
    /// A unit vector.
    pub(crate) direction: Vector3<f64>,
    /// From the node of the parent to its start; the start itself of a limb without a parent.
    pub(crate) offset: Vector3<f64>,
    pub(crate) length: f64,
    /// At the root and at the tip.
    pub(crate) radii: [f64; 2],
    /// Number of bones.
    pub(crate) n_bones: usize,
    /// Rotation from each bone to the next, at rest.
    pub(crate) curl: Matrix3<f64>,
    /// Greatest angle of every joint, in degrees.
    pub(crate) bend: f64,
    /// A direction, and the factor of the thickness along it.
    pub(crate) flattening: Option<([f64; 3], f64)>,
    /// Length of the first bone, inside the parent; otherwise it follows from the radius of the parent.
    pub(crate) buried: Option<f64>,
    /// Radius of a ball at the tip.
    pub(crate) knob: Option<f64>,
    /// Whether it has bones only.
    pub(crate) is_bare: bool,
    /// Instead of a tube of some length.
    pub(crate) ring: Option<Ring>,
}

/// A ring with the given radii of its hole and of its tube; the hole is seen along the normal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Ring {
    pub(crate) normal: Vector3<f64>,
    pub(crate) hole: f64,
    pub(crate) tube: f64,
}

impl Limb {
    /// Its mirror image under `x -> -x`.
    pub(crate) fn mirrored(&self) -> Self {
        let mut other = self.clone();
        other.direction.x = -other.direction.x;
        other.offset.x = -other.offset.x;
        let flip = Matrix3::from_diagonal(&[-1.0, 1.0, 1.0].into());
        other.curl = flip * other.curl * flip;
        if let Some((direction, _)) = &mut other.flattening {
            direction[0] = -direction[0];
        }
        if let Some(ring) = &mut other.ring {
            ring.normal.x = -ring.normal.x;
        }
        other
    }
}

/// A body in the making.
#[derive(Debug, Clone, Default)]
pub(crate) struct Draft {
    pub(crate) skeleton: Skeleton,
    /// What makes up the body.
    pub(crate) parts: Vec<BodyPart>,
    /// Number of handles.
    pub(crate) genus: usize,
    /// The smallest radius.
    pub(crate) finest: Option<f64>,
}

impl Draft {
    /// Adds a part that has no bones of its own; its smallest radius is `finest`.
    pub(crate) fn skin(&mut self, part: BodyPart, finest: f64) {
        self.finest = Some(self.finest.map_or(finest, |least| least.min(finest)));
        self.parts.push(part);
    }

    /// Adds a limb at a node of a chain, or the first limb, which carries the others. The length of a limb is what sticks
    /// out of the parent.
    pub(crate) fn limb(&mut self, root: Option<(usize, usize)>, limb: &Limb) -> usize {
        if let Some(ring) = limb.ring {
            return self.ring(root, ring, limb);
        }
        let axis = self.axis(root, limb);
        if !limb.is_bare {
            self.tube(&axis, limb);
        }
        self.chain(root, &axis, limb)
    }

    fn ring(
        &mut self,
        root: Option<(usize, usize)>,
        Ring { normal, hole, tube }: Ring,
        limb: &Limb,
    ) -> usize {
        let bones = Limb { length: 2.0 * hole, radii: [hole; 2], ..limb.clone() };
        let start = self.axis(root, &Limb { radii: [tube; 2], ..bones.clone() });
        // From the root to the near side of the ring and to its far side.
        let near = start[1];
        let center = near + limb.direction * hole;
        let (u, v) = (limb.direction, normal.cross(&limb.direction).normalize());
        let at = |i: usize| {
            let (sin, cos) = sin_cos(2.0 * PI * (i % N_SIDES) as f64 / N_SIDES as f64);
            ball(center + (u * cos + v * sin) * hole, tube)
        };
        let sides = (0..N_SIDES).map(|i| Blob::new([at(i), at(i + 1)], None, 0.0)).collect();
        self.skin(BodyPart::new(false, sides, BLEND * tube), tube);
        self.chain(root, &[start[0], near, center, near + limb.direction * bones.length], &bones)
    }

    /// The nodes of a limb, the first inside its parent.
    fn axis(&self, root: Option<(usize, usize)>, limb: &Limb) -> Vec<Point3<f64>> {
        let Some((chain, at)) = root else { return axis(limb.offset.into(), 0.0, limb) };
        let parent = self.skeleton.chains[chain].nodes[at];
        let default = (parent.radius - limb.offset.norm()).max(0.5 * limb.radii[0]);
        axis(parent.at + limb.offset, limb.buried.unwrap_or(default), limb)
    }

    fn chain(&mut self, parent: Option<(usize, usize)>, axis: &[Point3<f64>], limb: &Limb) -> usize {
        let squeezed = limb.flattening.map_or(1.0, |(_, factor)| factor.sqrt());
        let mut radii = radii(axis.len(), limb);
        if let (Some(last), Some(knob)) = (radii.last_mut(), limb.knob) {
            *last = knob;
        }
        let nodes: Vec<BoneNode> = axis
            .iter()
            .zip(&radii)
            .map(|(at, radius)| BoneNode { at: *at, radius: radius * squeezed, grain: grain(*radius) })
            .collect();
        let inner = 1..axis.len() - 1;
        let joints = inner.map(|i| joint(&nodes, i, limb.bend)).collect();
        self.skeleton.chain(parent, nodes, joints)
    }

    fn tube(&mut self, axis: &[Point3<f64>], limb: &Limb) {
        let radii = radii(axis.len(), limb);
        let at = |i: usize| ball(axis[i], radii[i]);
        let cone = |i: usize| Blob::new([at(i), at(i + 1)], limb.flattening, 0.0);
        let mut blobs: Vec<Blob> = (0..axis.len() - 1).map(cone).collect();
        if let Some(radius) = limb.knob {
            blobs.push(Blob::new([ball(axis[axis.len() - 1], radius); 2], None, 0.5 * limb.radii[1]));
        }
        let squeezed = limb.flattening.map_or(1.0, |(_, factor)| factor);
        let finest = limb.radii[0].min(limb.radii[1]) * squeezed;
        self.skin(BodyPart::new(false, blobs, BLEND * limb.radii[0]), finest);
    }
}

fn ball(at: Point3<f64>, radius: f64) -> [f64; 4] {
    [at.x, at.y, at.z, radius]
}

/// The nodes of a limb from `start`, of which the first bone is longer by `buried`.
fn axis(start: Point3<f64>, buried: f64, limb: &Limb) -> Vec<Point3<f64>> {
    let (mut at, mut direction) = (start, limb.direction);
    let mut nodes = vec![at];
    if buried > 0.0 {
        at += direction * buried;
        nodes.push(at);
    }
    for _ in 0..limb.n_bones {
        at += direction * (limb.length / limb.n_bones as f64);
        nodes.push(at);
        direction = limb.curl * direction;
    }
    nodes
}

/// The radius at every node, linear from root to tip.
fn radii(n_nodes: usize, limb: &Limb) -> Vec<f64> {
    let [root, tip] = limb.radii;
    (0..n_nodes).map(|i| root + (tip - root) * i as f64 / (n_nodes - 1) as f64).collect()
}

/// The target edge length of triangles on a limb: finer where it is thin.
fn grain(radius: f64) -> f64 {
    (radius / 20.0).sqrt().clamp(0.35, 1.1)
}

/// The joint at an inner node.
fn joint(nodes: &[BoneNode], i: usize, bend: f64) -> Joint {
    let [before, after] = [nodes[i].at - nodes[i - 1].at, nodes[i + 1].at - nodes[i].at];
    let lengths = [before, after].map(|bone| 0.5 * bone.norm());
    let strained = (STRAIN * (lengths[0] + lengths[1]) / nodes[i].radius.max(1e-9)).to_degrees();
    let bend = bend.min(strained);
    // The second axis is the direction of the limb, about which it hardly turns.
    let along = after.normalize();
    let x = Vector3::ith(along.iamin(), 1.0).cross(&along).normalize();
    let frame = Matrix3::from_columns(&[x, along, x.cross(&along)]);
    let play = [bend, 0.25 * bend, bend].map(|bend| PLAY * bend);
    Joint { node: i, before: lengths[0], after: lengths[1], frame, play }
}
