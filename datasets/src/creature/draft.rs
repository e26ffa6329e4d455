//! A body under construction: limbs with their bones.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Point3, Vector3};

use crate::implicit::{Blob, BodyPart, ImplicitBody};
use crate::skeleton::{BoneNode, Joint, Skeleton, node};
use crate::trig::{rotation, sin_cos};

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
    direction: Vector3<f64>,
    /// From the node of the parent to its start; the start itself of a limb without a parent.
    offset: Vector3<f64>,
    length: f64,
    /// At the root and at the tip.
    radii: [f64; 2],
    /// Number of bones.
    n_bones: usize,
    /// Rotation from each bone to the next, at rest.
    curl: Matrix3<f64>,
    /// Greatest angle of every joint, in degrees.
    bend: f64,
    flattening: Option<([f64; 3], f64)>,
    /// Length of the first bone, inside the parent.
    buried: Option<f64>,
    /// Radius of a ball at the tip.
    knob: Option<f64>,
}

impl Limb {
    /// A straight limb of one bone with the given radii of root and tip.
    pub(crate) fn new(direction: [f64; 3], length: f64, radii: [f64; 2]) -> Self {
        Self {
            direction: Vector3::from(direction).normalize(),
            offset: Vector3::zeros(),
            length,
            radii,
            n_bones: 1,
            curl: Matrix3::identity(),
            bend: 0.0,
            flattening: None,
            buried: None,
            knob: None,
        }
    }

    /// Divides the limb into equal bones, with joints that bend by up to `bend` degrees.
    pub(crate) fn bones(self, n_bones: usize, bend: f64) -> Self {
        Self { n_bones, bend, ..self }
    }

    /// Curves the limb at rest: every bone but the first is turned by these angles about x, y and z.
    pub(crate) fn curled(self, [x, y, z]: [f64; 3]) -> Self {
        Self { curl: rotation(x, y, z), ..self }
    }

    /// Squeezes the limb along a direction to a factor of its thickness.
    pub(crate) fn flat(self, direction: [f64; 3], factor: f64) -> Self {
        Self { flattening: Some((direction, factor)), ..self }
    }

    /// The same limb in another direction.
    pub(crate) fn towards(&self, direction: [f64; 3]) -> Self {
        Self { direction: Vector3::from(direction).normalize(), ..self.clone() }
    }

    /// The same limb from another point, relative to the node of its parent.
    pub(crate) fn at(&self, offset: [f64; 3]) -> Self {
        Self { offset: offset.into(), ..self.clone() }
    }

    /// The same limb with another length.
    pub(crate) fn long(self, length: f64) -> Self {
        Self { length, ..self }
    }

    /// Sets the length inside the parent; otherwise it follows from the radius of the parent.
    pub(crate) fn buried(self, buried: f64) -> Self {
        Self { buried: Some(buried), ..self }
    }

    /// Adds a ball at the tip.
    pub(crate) fn knob(self, radius: f64) -> Self {
        Self { knob: Some(radius), ..self }
    }
}

/// A body in the making.
#[derive(Debug, Clone, Default)]
pub(crate) struct Draft {
    pub(crate) skeleton: Skeleton,
    parts: Vec<BodyPart>,
    /// Number of handles.
    pub(crate) genus: usize,
    /// The smallest radius.
    pub(crate) finest: Option<f64>,
}

impl Draft {
    /// The body that the parts make up.
    pub(crate) fn body(&self) -> ImplicitBody {
        ImplicitBody::whole(self.parts.clone())
    }

    /// Adds a part that has no bones of its own; its smallest radius is `finest`.
    pub(crate) fn skin(&mut self, part: BodyPart, finest: f64) {
        self.finest = Some(self.finest.map_or(finest, |least| least.min(finest)));
        self.parts.push(part);
    }

    /// Adds the first limb, which carries the others.
    pub(crate) fn trunk(&mut self, limb: &Limb) -> usize {
        let axis = axis(limb.offset.into(), 0.0, limb);
        self.tube(&axis, limb);
        self.chain(None, &axis, limb)
    }

    /// Adds the first chain of bones without any skin.
    pub(crate) fn bones(&mut self, limb: &Limb) -> usize {
        self.chain(None, &axis(limb.offset.into(), 0.0, limb), limb)
    }

    /// Adds a limb at a node of a chain. Its length is what sticks out of the parent.
    pub(crate) fn limb(&mut self, root: (usize, usize), limb: &Limb) -> usize {
        let axis = self.rooted(root, limb);
        self.tube(&axis, limb);
        self.chain(Some(root), &axis, limb)
    }

    /// Adds a limb and its mirror image under `x -> -x`.
    pub(crate) fn limbs(&mut self, root: (usize, usize), limb: &Limb) -> [usize; 2] {
        let mut other = limb.clone();
        other.direction.x = -other.direction.x;
        other.offset.x = -other.offset.x;
        let flip = Matrix3::from_diagonal(&[-1.0, 1.0, 1.0].into());
        other.curl = flip * other.curl * flip;
        if let Some((direction, _)) = &mut other.flattening {
            direction[0] = -direction[0];
        }
        [limb, &other].map(|limb| self.limb(root, limb))
    }

    /// Adds a ring with the given radii around its hole and of its tube, which starts at a node of a chain. `limb` says
    /// where it goes; the hole is seen along `normal`.
    pub(crate) fn ring(
        &mut self,
        root: (usize, usize),
        normal: [f64; 3],
        [hole, tube]: [f64; 2],
        limb: &Limb,
    ) {
        let reach = 2.0 * hole;
        let bones = Limb { length: reach, radii: [hole; 2], ..limb.clone() };
        let start = self.rooted(root, &Limb { radii: [tube; 2], ..bones.clone() });
        // From the root to the near side of the ring and to its far side.
        let near = start[1];
        let axis = [start[0], near, near + bones.direction * hole, near + bones.direction * reach];
        self.chain(Some(root), &axis, &bones);
        self.torus(axis[2], limb.direction, normal.into(), [hole, tube]);
    }

    /// Adds a ring without bones: `across` is a direction in its plane.
    pub(crate) fn torus(
        &mut self,
        centre: Point3<f64>,
        across: Vector3<f64>,
        normal: Vector3<f64>,
        [hole, tube]: [f64; 2],
    ) {
        let u = across.normalize();
        let v = normal.cross(&u).normalize();
        let at = |i: usize| {
            let (sin, cos) = sin_cos(2.0 * PI * (i % N_SIDES) as f64 / N_SIDES as f64);
            (centre + (u * cos + v * sin) * hole).coords.into()
        };
        let sides = (0..N_SIDES).map(|i| Blob::cone(at(i), tube, at(i + 1), tube)).collect();
        self.skin(BodyPart::added(sides).blend(BLEND * tube), tube);
        self.genus += 1;
    }

    /// The nodes of a limb of the chain `root`, the first inside its parent.
    fn rooted(&self, (chain, at): (usize, usize), limb: &Limb) -> Vec<Point3<f64>> {
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
            .map(|(at, radius)| node(at.coords.into(), radius * squeezed, grain(*radius)))
            .collect();
        let inner = 1..axis.len() - 1;
        let joints = inner.map(|i| joint(&nodes, i, limb.bend)).collect();
        self.skeleton.chain(parent, nodes, joints)
    }

    fn tube(&mut self, axis: &[Point3<f64>], limb: &Limb) {
        let radii = radii(axis.len(), limb);
        let flat = |blob: Blob| match limb.flattening {
            Some((direction, factor)) => blob.flat(direction, factor),
            None => blob,
        };
        let at = |i: usize| axis[i].coords.into();
        let cone = |i: usize| flat(Blob::cone(at(i), radii[i], at(i + 1), radii[i + 1]));
        let mut blobs: Vec<Blob> = (0..axis.len() - 1).map(cone).collect();
        if let Some(radius) = limb.knob {
            blobs.push(Blob::ball(at(axis.len() - 1), radius).blend(0.5 * limb.radii[1]));
        }
        let squeezed = limb.flattening.map_or(1.0, |(_, factor)| factor);
        let finest = limb.radii[0].min(limb.radii[1]) * squeezed;
        self.skin(BodyPart::added(blobs).blend(BLEND * limb.radii[0]), finest);
    }
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
    let least = along.iamin();
    let mut side = Vector3::zeros();
    side[least] = 1.0;
    let x = side.cross(&along).normalize();
    let frame = Matrix3::from_columns(&[x, along, x.cross(&along)]);
    let play = [bend, 0.25 * bend, bend].map(|bend| PLAY * bend);
    Joint { node: i, before: lengths[0], after: lengths[1], frame, play }
}
