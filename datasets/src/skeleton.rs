//! Chains of bones through the rest-pose body, and where a point of the body sits along them.

use nalgebra::{Matrix3, Point3, Vector3};

/// A point on the axis of a limb.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) at: Point3<f64>,
    /// Rough distance from the axis to the skin: thick chains reach farther than thin ones.
    pub(crate) radius: f64,
    /// Wanted edge length of triangles around here, up to a common factor.
    pub(crate) grain: f64,
}

/// Shorthand for tables of nodes.
pub(crate) fn node(at: [f64; 3], radius: f64, grain: f64) -> Node {
    Node { at: at.into(), radius, grain }
}

impl Node {
    /// The node scaled about the origin, then shifted; its grain stays.
    pub(crate) fn moved(self, scale: f64, offset: [f64; 3]) -> Self {
        let at = Point3::from(self.at.coords * scale + Vector3::from(offset));
        Self { at, radius: self.radius * scale, grain: self.grain }
    }
}

/// A place where a chain bends.
///
/// The turn is spread over an interval of the axis: the limb becomes a bent tube, whose axis keeps its
/// length, rather than a folded one.
#[derive(Debug, Clone)]
pub(crate) struct Joint {
    /// Node around which it bends.
    pub(crate) node: usize,
    /// Length of axis before the node that takes part.
    pub(crate) before: f64,
    /// Length of axis after the node that takes part.
    pub(crate) after: f64,
    /// Columns are the axes of its turns.
    pub(crate) frame: Matrix3<f64>,
    /// Random play about each axis, in degrees either way.
    pub(crate) play: [f64; 3],
}

/// Names a joint of a skeleton.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct JointId {
    pub(crate) chain: usize,
    pub(crate) joint: usize,
}

/// The same joint on the left (`x > 0`) and on the right.
pub(crate) type JointPair = [JointId; 2];

/// Bones in a row: an arm, a spine.
#[derive(Debug, Clone)]
pub(crate) struct Chain {
    /// Chain and length along it where this one is fixed; its parent comes earlier in the skeleton.
    pub(crate) parent: Option<(usize, f64)>,
    pub(crate) nodes: Vec<Node>,
    /// Length of the axis from the first node to each node.
    pub(crate) arcs: Vec<f64>,
    pub(crate) joints: Vec<Joint>,
    /// Whether it is the mirror image, under `x -> -x`, of the chain its joints were described for.
    pub(crate) side: Side,
}

impl Chain {
    /// Length of the axis.
    pub(crate) fn length(&self) -> f64 {
        self.arcs[self.arcs.len() - 1]
    }

    /// The bone at length `arc` along the axis, by the node it begins with, and the share of it before
    /// that place.
    pub(crate) fn bone_at(&self, arc: f64) -> (usize, f64) {
        let i = self.arcs[1..self.arcs.len() - 1].partition_point(|&a| a <= arc);
        let t = (arc - self.arcs[i]) / (self.arcs[i + 1] - self.arcs[i]);
        (i, t.clamp(0.0, 1.0))
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Side {
    /// As described: in the middle, or at `x > 0`.
    Left,
    /// Mirrored.
    Right,
}

/// All chains of a body, parents first.
#[derive(Debug, Clone, Default)]
pub(crate) struct Skeleton {
    pub(crate) chains: Vec<Chain>,
}

/// Position of a point along a chain and how much it belongs to it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Membership {
    /// Length along the axis.
    pub(crate) arc: f64,
    /// Share, not normalised over the chains.
    pub(crate) weight: f64,
    pub(crate) grain: f64,
}

impl Skeleton {
    /// Adds a chain fixed at node `parent.1` of chain `parent.0`, with its joints.
    pub(crate) fn chain(
        &mut self,
        parent: Option<(usize, usize)>,
        nodes: Vec<Node>,
        joints: Vec<Joint>,
    ) -> usize {
        let mut arcs = vec![0.0];
        for pair in nodes.windows(2) {
            arcs.push(arcs[arcs.len() - 1] + (pair[1].at - pair[0].at).norm());
        }
        let parent = parent.map(|(chain, node)| (chain, self.chains[chain].arcs[node]));
        self.chains.push(Chain { parent, nodes, arcs, joints, side: Side::Left });
        self.chains.len() - 1
    }

    /// Adds a chain and its mirror image.
    pub(crate) fn pair(
        &mut self,
        parent: (usize, usize),
        nodes: Vec<Node>,
        joints: Vec<Joint>,
    ) -> [usize; 2] {
        let left = self.chain(Some(parent), nodes, joints);
        let mut mirrored = self.chains[left].clone();
        for node in &mut mirrored.nodes {
            node.at.x = -node.at.x;
        }
        mirrored.side = Side::Right;
        self.chains.push(mirrored);
        [left, left + 1]
    }

    /// How `p` belongs to each chain.
    ///
    /// Each segment claims `p` with the eighth power of `radius / distance`; claims of the segments of
    /// a chain add up and average their arc lengths, so that nothing jumps where limbs or segments
    /// meet.
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

    /// Wanted edge length at `p`, up to a common factor.
    pub(crate) fn grain(&self, p: Point3<f64>) -> f64 {
        let (sum, weight) = self
            .memberships(p)
            .fold((0.0, 0.0), |(sum, weight), m| (sum + m.weight * m.grain, weight + m.weight));
        sum / weight
    }
}

impl Joint {
    /// A joint that turns about the axes of the body.
    pub(crate) fn ball(node: usize, before: f64, after: f64, play: [f64; 3]) -> Self {
        Self { node, before, after, frame: Matrix3::identity(), play }
    }

    /// A joint that flexes about `axis`; its second axis is the limb's direction `along`.
    pub(crate) fn hinge(
        node: usize,
        before: f64,
        after: f64,
        axis: [f64; 3],
        along: [f64; 3],
        play: f64,
    ) -> Self {
        let x = Vector3::from(axis).normalize();
        let along = Vector3::from(along);
        let y = (along - x * x.dot(&along)).normalize();
        let frame = Matrix3::from_columns(&[x, y, x.cross(&y)]);
        Self { node, before, after, frame, play: [play, 0.0, 0.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_belong_to_the_nearest_chain_at_their_arc_length() {
        let mut skeleton = Skeleton::default();
        let trunk = skeleton.chain(
            None,
            vec![
                node([0.0, 0.0, 0.0], 4.0, 1.0),
                node([0.0, 0.0, 10.0], 4.0, 1.0),
                node([0.0, 0.0, 30.0], 4.0, 2.0),
            ],
            Vec::new(),
        );
        skeleton.pair(
            (trunk, 1),
            vec![node([5.0, 0.0, 10.0], 2.0, 0.5), node([25.0, 0.0, 10.0], 2.0, 0.5)],
            Vec::new(),
        );
        let at = |p: [f64; 3]| skeleton.memberships(p.into()).collect::<Vec<_>>();
        let high = at([0.0, 4.0, 25.0]);
        assert!((high[0].arc - 25.0).abs() < 0.1 && (high[0].grain - 1.75).abs() < 0.01);
        assert!(high[0].weight > 1e3 * high[1].weight);
        let left = at([20.0, 2.0, 10.0]);
        assert!((left[1].arc - 15.0).abs() < 1e-9);
        assert!(left[1].weight > 100.0 * left[0].weight && left[1].weight > 1e6 * left[2].weight);
        let right = at([-20.0, 2.0, 10.0]);
        assert_eq!((left[1].arc, left[1].weight), (right[2].arc, right[2].weight));
        assert!((skeleton.grain([20.0, 2.0, 10.0].into()) - 0.5).abs() < 0.02);
    }

    #[test]
    fn a_hinge_has_an_orthogonal_frame() {
        let hinge = Joint::hinge(1, 1.0, 1.0, [1.0, 0.2, 0.0], [0.3, 0.1, -2.0], 5.0);
        assert!((hinge.frame.transpose() * hinge.frame - Matrix3::identity()).norm() < 1e-12);
        assert!((hinge.frame.determinant() - 1.0).abs() < 1e-12);
    }
}
