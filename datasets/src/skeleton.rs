//! Chains of bones in the body at rest, and the position of a point of the body along them.

use nalgebra::{Matrix3, Point3};

/// A point on the axis of a limb.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BoneNode {
    pub(crate) at: Point3<f64>,
    /// Rough distance from the axis to the skin; it determines how far the chain reaches.
    pub(crate) radius: f64,
    /// Target edge length of the triangles nearby, up to a common factor.
    pub(crate) grain: f64,
}

/// A place where a chain bends.
///
/// The rotation is spread over an interval of the axis, so that the limb becomes a bent tube whose axis keeps
/// its length.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    /// Node at its center.
    pub(crate) node: usize,
    /// Length of the interval before the node.
    pub(crate) before: f64,
    /// Length of the interval after the node.
    pub(crate) after: f64,
    /// Columns are the axes of rotation.
    pub(crate) frame: Matrix3<f64>,
    /// Random play about each axis, in degrees in either direction.
    pub(crate) play: [f64; 3],
}

/// A sequence of bones, such as an arm or a spine.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    /// The chain to which this one is attached, and the length along it; parents come earlier in the skeleton.
    pub(crate) parent: Option<(usize, f64)>,
    pub(crate) nodes: Vec<BoneNode>,
    /// Length of the axis from the first node to each node.
    pub(crate) arcs: Vec<f64>,
    pub(crate) joints: Vec<Joint>,
    /// Whether it is the mirror image, under `x -> -x`, of the chain for which its joints were described.
    pub(crate) is_mirrored: bool,
}

impl Chain {
    /// Length of the axis.
    pub(crate) fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// First node of the bone at length `arc` along the axis, and the share of the bone before that place.
    pub(crate) fn bone_at(&self, arc: f64) -> (usize, f64) {
        let i = self.arcs[1..self.arcs.len() - 1].partition_point(|&a| a <= arc);
        let t = (arc - self.arcs[i]) / (self.arcs[i + 1] - self.arcs[i]);
        (i, t.clamp(0.0, 1.0))
    }
}

/// All chains of a body, parents first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Skeleton {
    pub(crate) chains: Vec<Chain>,
}

/// Position of a point along a chain, and its weight.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Membership {
    /// Length along the axis.
    pub(crate) arc: f64,
    /// Not normalized over the chains.
    pub(crate) weight: f64,
    pub(crate) grain: f64,
}

impl Skeleton {
    /// Adds a chain attached to node `parent.1` of chain `parent.0`, with its joints.
    pub(crate) fn chain(
        &mut self,
        parent: Option<(usize, usize)>,
        nodes: Vec<BoneNode>,
        joints: Vec<Joint>,
    ) -> usize {
        let mut arcs = vec![0.0];
        for pair in nodes.windows(2) {
            arcs.push(arcs[arcs.len() - 1] + (pair[1].at - pair[0].at).norm());
        }
        let parent = parent.map(|(chain, node)| (chain, self.chains[chain].arcs[node]));
        self.chains.push(Chain { parent, nodes, arcs, joints, is_mirrored: false });
        self.chains.len() - 1
    }

    /// Adds the mirror image of the last chain.
    pub(crate) fn mirror(&mut self, chain: usize) -> usize {
        let mut mirrored = Chain { is_mirrored: true, ..self.chains[chain].clone() };
        mirrored.nodes.iter_mut().for_each(|node| node.at.x = -node.at.x);
        self.chains.push(mirrored);
        self.chains.len() - 1
    }

    /// The membership of `p` in each chain.
    ///
    /// The weight of a segment is the eighth power of `radius / distance`. The weights of the segments of a chain add
    /// up and average their arc lengths, so that everything is continuous where limbs or segments meet.
    pub(crate) fn memberships(&self, p: Point3<f64>) -> impl Iterator<Item = Membership> + '_ {
        self.chains.iter().map(move |chain| {
            let mut sum = Membership { arc: 0.0, weight: 0.0, grain: 0.0 };
            for (i, pair) in chain.nodes.windows(2).enumerate() {
                let axis = pair[1].at - pair[0].at;
                let t = ((p - pair[0].at).dot(&axis) / axis.norm_squared()).clamp(0.0, 1.0);
                let between = |a: f64, b: f64| a + (b - a) * t;
                let squared = (p - pair[0].at - axis * t).norm_squared();
                let radius = between(pair[0].radius, pair[1].radius);
                let closeness = radius * radius / (squared + 1e-4 * radius * radius);
                let square = closeness * closeness;
                let claim = square * square;
                sum.arc += claim * between(chain.arcs[i], chain.arcs[i + 1]);
                sum.grain += claim * between(pair[0].grain, pair[1].grain);
                sum.weight += claim;
            }
            Membership { arc: sum.arc / sum.weight, grain: sum.grain / sum.weight, weight: sum.weight }
        })
    }

    /// Target edge length at `p`, up to a common factor.
    pub(crate) fn grain(&self, p: Point3<f64>) -> f64 {
        let (sum, weight) = self
            .memberships(p)
            .fold((0.0, 0.0), |(sum, weight), m| (sum + m.weight * m.grain, weight + m.weight));
        sum / weight
    }
}
