//! Bodies: from their descriptions in `bodies/*.toml` to implicit surfaces, skeletons and poses.

use std::collections::{BTreeMap, HashMap};

use nalgebra::{Matrix3, Vector3};
use serde::Deserialize;

use crate::implicit::{Blob, BodyPart, ImplicitBody};
use crate::pose::{JointTurn, Pose};
use crate::skeleton::{BoneNode, Joint, Skeleton};

/// A body at rest, its skeleton and its poses.
#[derive(Debug, Clone)]
pub(crate) struct BodyModel {
    pub(crate) body: ImplicitBody,
    pub(crate) skeleton: Skeleton,
    /// Typical poses; the first is the rest pose.
    pub(crate) poses: Vec<Pose>,
    /// Number of handles of the rest surface.
    pub(crate) genus: usize,
    /// Area of the rest surface, in squared body units; families are scaled to a common one.
    pub(crate) area: f64,
    /// Coarsest lattice that resolves the smallest features, in body units.
    pub(crate) spacing: f64,
}

/// The content of a file. Parts and chains are on the left (`x > 0`) or in the middle.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct BodyDescription {
    area: f64,
    spacing: f64,
    parts: Vec<PartData>,
    chains: Vec<ChainData>,
    poses: Vec<PoseData>,
}

/// Blobs that belong together; see [`BodyPart`].
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PartData {
    #[serde(default)]
    carved: bool,
    #[serde(default)]
    blend: f64,
    blobs: Vec<BlobData>,
}

/// A ball, or round cones in a row.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct BlobData {
    /// Points with the radius there.
    axis: Vec<[f64; 4]>,
    /// A direction, and the factor of the thickness along it.
    flat: Option<([f64; 3], f64)>,
    #[serde(default)]
    blend: f64,
}

/// Bones; see [`Chain`](crate::skeleton::Chain).
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ChainData {
    name: String,
    /// The chain to which it is attached, at its `node`.
    parent: Option<String>,
    #[serde(default)]
    node: usize,
    /// Whether it has a mirror image on the right.
    #[serde(default)]
    pair: bool,
    /// Position, radius and grain.
    nodes: Vec<[f64; 5]>,
    #[serde(default)]
    joints: Vec<JointData>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct JointData {
    /// Its name in poses.
    name: Option<String>,
    /// Its node.
    at: usize,
    /// How far it bends the chain before and behind the node.
    reach: [f64; 2],
    play: [f64; 3],
    /// The axis about which it flexes and the direction of the limb; otherwise it turns about the axes of the body.
    hinge: Option<[[f64; 3]; 2]>,
}

/// The joints that are not at rest.
#[derive(Debug, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct PoseData {
    root: JointTurn,
    /// By the name of a chain, the turns of its joints from the trunk down, on the left and perhaps on the right.
    chains: BTreeMap<String, Vec<Vec<JointTurn>>>,
    /// By the name of a joint, its turn on the left and on the right, or that on both sides.
    turns: BTreeMap<String, Vec<JointTurn>>,
}

impl BodyModel {
    /// The body of a file.
    ///
    /// # Panics
    /// If the text is no description: it is one of ours, which tests read.
    pub(crate) fn read(text: &str) -> Self {
        let all: BodyDescription = toml::from_str(text).unwrap_or_else(|fault| panic!("a body: {fault}"));
        let body = ImplicitBody { parts: all.parts.iter().map(PartData::part).collect(), is_symmetric: true };
        let (skeleton, names) = all.skeleton();
        let poses = all.poses.iter().map(|pose| pose.pose(&skeleton, &names)).collect();
        Self { body, skeleton, poses, genus: 0, area: all.area, spacing: all.spacing }
    }
}

/// By name: joints, each with its chain and its number there, and chains; on the left and on the right.
#[derive(Default)]
struct JointNames<'a> {
    joints: HashMap<&'a str, Vec<[usize; 2]>>,
    chains: HashMap<&'a str, Vec<usize>>,
}

impl BodyDescription {
    fn skeleton(&self) -> (Skeleton, JointNames<'_>) {
        let (mut skeleton, mut names) = (Skeleton::default(), JointNames::default());
        for data in &self.chains {
            let parent = data.parent.as_deref().map(|name| (names.chains[name][0], data.node));
            let node =
                |&[x, y, z, radius, grain]: &[f64; 5]| BoneNode { at: [x, y, z].into(), radius, grain };
            let nodes = data.nodes.iter().map(node).collect();
            let joints = data.joints.iter().map(JointData::joint).collect();
            let mut chains = vec![skeleton.chain(parent, nodes, joints)];
            if data.pair {
                chains.push(skeleton.mirror(chains[0]));
            }
            for (joint, JointData { name, .. }) in data.joints.iter().enumerate() {
                let ids = chains.iter().map(|&chain| [chain, joint]).collect();
                name.iter().for_each(|name| drop(names.joints.insert(name, Vec::clone(&ids))));
            }
            names.chains.insert(&data.name, chains);
        }
        (skeleton, names)
    }
}

impl PartData {
    fn part(&self) -> BodyPart {
        let blobs = self.blobs.iter().flat_map(BlobData::blobs).collect();
        BodyPart::new(self.carved, blobs, self.blend)
    }
}

impl BlobData {
    fn blobs(&self) -> impl Iterator<Item = Blob> {
        let last = self.axis.len() - 1;
        (0..last.max(1))
            .map(move |i| Blob::new([self.axis[i], self.axis[last.min(i + 1)]], self.flat, self.blend))
    }
}

impl JointData {
    fn joint(&self) -> Joint {
        let hinge = |[axis, along]: [[f64; 3]; 2]| {
            let (x, along) = (Vector3::from(axis).normalize(), Vector3::from(along));
            let y = (along - x * x.dot(&along)).normalize();
            Matrix3::from_columns(&[x, y, x.cross(&y)])
        };
        let frame = self.hinge.map_or_else(Matrix3::identity, hinge);
        let [before, after] = self.reach;
        Joint { node: self.at, before, after, frame, play: self.play }
    }
}

impl PoseData {
    fn pose(&self, skeleton: &Skeleton, names: &JointNames<'_>) -> Pose {
        let mut pose = Pose::rest(skeleton);
        pose.root = self.root;
        for (name, sides) in &self.chains {
            for (&chain, turns) in names.chains[name.as_str()].iter().zip(sides) {
                pose.turns[chain][..turns.len()].copy_from_slice(turns);
            }
        }
        for (name, sides) in &self.turns {
            let joints = names.joints[name.as_str()].iter().zip(sides.iter().cycle());
            joints.for_each(|(&[chain, joint], turn)| pose.turns[chain][joint] = *turn);
        }
        pose
    }
}
