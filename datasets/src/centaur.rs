//! A centaur: the body of a horse, and a man's trunk, arms and head where its neck would be.
//!
//! Centimetres; `z` up, facing `-y`, its left at `x > 0`. Angles in degrees, with the signs of cat (legs,
//! trunk, tail) and david (arms, neck).

use crate::human;
use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, Turn, turn};
use crate::skeleton::{Joint, JointId, JointPair, Node, Skeleton, node};

/// The man's size and place: his navel comes above the horse's shoulders.
const MAN_SCALE: f64 = 1.0;
const MAN_OFFSET: [f64; 3] = [0.0, -46.0, 14.0];
/// The man is small beside the horse: his hands and face need smaller triangles.
const MAN_GRAIN: f64 = 0.7;

/// The family's model.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, area: 41_250.0, spacing: 1.0 }
}

fn body() -> Body {
    let mut parts = vec![barrel()];
    parts.extend(human::parts().iter().map(|part| part.moved(MAN_SCALE, MAN_OFFSET)));
    parts.extend([foreleg(), hindleg(), hoof(-48.0), hoof(47.0), ground(), tail()]);
    Body::new(parts)
}

fn barrel() -> Part {
    let sideways = [1.0, 0.0, 0.0];
    Part::added(
        0.0,
        vec![
            Blob::cone([0.0, -34.0, 93.0], 23.0, [0.0, 6.0, 92.0], 24.0).flat(sideways, 0.84),
            Blob::cone([0.0, 6.0, 92.0], 24.0, [0.0, 40.0, 95.0], 21.5).flat(sideways, 0.84).blend(1.0),
            // Croup and breast.
            Blob::cone([0.0, 40.0, 96.0], 21.5, [0.0, 52.0, 97.0], 18.0).flat(sideways, 0.9).blend(3.0),
            Blob::cone([0.0, -44.0, 92.0], 18.5, [0.0, -46.0, 112.0], 13.5).flat(sideways, 0.95).blend(5.0),
        ],
    )
}

fn foreleg() -> Part {
    Part::added(
        6.0,
        vec![
            Blob::cone([10.0, -38.0, 98.0], 11.5, [11.5, -46.0, 82.0], 11.5),
            Blob::cone([11.5, -46.0, 82.0], 11.0, [12.0, -41.0, 64.0], 8.0).blend(2.0),
            Blob::cone([12.0, -41.0, 64.0], 7.8, [12.5, -43.0, 40.0], 4.8).blend(1.5),
            Blob::ball([12.5, -43.6, 39.0], 5.0).blend(1.5),
            Blob::cone([12.5, -43.0, 38.0], 4.2, [12.5, -42.0, 14.0], 3.6).blend(1.0),
            Blob::ball([12.5, -41.6, 13.0], 4.2).blend(1.5),
            Blob::cone([12.5, -42.0, 13.0], 3.6, [12.5, -46.0, 6.0], 3.8).blend(1.0),
        ],
    )
}

fn hindleg() -> Part {
    Part::added(
        7.0,
        vec![
            Blob::cone([10.5, 44.0, 92.0], 17.0, [13.0, 38.0, 70.0], 11.5),
            Blob::cone([13.0, 38.0, 69.0], 10.5, [13.0, 56.0, 45.0], 5.0).blend(2.5),
            Blob::ball([13.0, 56.6, 44.5], 5.0).blend(1.5),
            Blob::cone([13.0, 56.0, 44.0], 4.6, [13.0, 53.0, 14.0], 3.8).blend(1.0),
            Blob::ball([13.0, 53.4, 13.0], 4.3).blend(1.5),
            Blob::cone([13.0, 53.0, 13.0], 3.8, [12.8, 49.0, 6.0], 3.9).blend(1.0),
        ],
    )
}

fn hoof(y: f64) -> Part {
    Part::added(1.0, vec![Blob::cone([12.7, y + 1.0, 7.5], 3.9, [12.7, y - 1.2, 1.0], 5.6)])
}

/// Hooves are flat below: a ball so large that its top is the ground.
fn ground() -> Part {
    const RADIUS: f64 = 2000.0;
    Part::carved(0.8, vec![Blob::ball([0.0, 0.0, 0.4 - RADIUS], RADIUS)])
}

/// The axis of the tail at rest.
const TAIL: [[f64; 3]; 5] =
    [[0.0, 68.0, 103.0], [0.0, 78.0, 98.0], [0.0, 85.0, 84.0], [0.0, 89.0, 66.0], [0.0, 91.0, 46.0]];

fn tail() -> Part {
    let radii = [4.4, 5.6, 6.8, 6.4, 2.6];
    let segment = |i: usize| Blob::cone(TAIL[i], radii[i], TAIL[i + 1], radii[i + 1]);
    let root = Blob::cone([0.0, 56.0, 103.0], 6.0, TAIL[0], radii[0]);
    Part::added(4.0, std::iter::once(root).chain((0..4).map(segment)).collect())
}

struct Joints {
    loin: JointId,
    /// Between the horse's back and the man's trunk.
    withers: JointId,
    waist: JointId,
    chest: JointId,
    neck: JointId,
    tail: [JointId; 4],
    arm_shoulder: JointPair,
    arm_elbow: JointPair,
    fingers: JointPair,
    shoulder: JointPair,
    elbow: JointPair,
    knee: JointPair,
    fetlock: JointPair,
    hip: JointPair,
    stifle: JointPair,
    hock: JointPair,
    hind_fetlock: JointPair,
}

fn man(nodes: Vec<Node>) -> Vec<Node> {
    let fine = |n: Node| Node { grain: n.grain * MAN_GRAIN, ..n.moved(MAN_SCALE, MAN_OFFSET) };
    nodes.into_iter().map(fine).collect()
}

fn skeleton() -> (Skeleton, Joints) {
    let mut skeleton = Skeleton::default();
    let mut nodes = vec![
        node([0.0, 46.0, 96.0], 18.0, 1.2),
        node([0.0, 18.0, 94.0], 20.0, 1.3),
        node([0.0, -14.0, 94.0], 20.0, 1.3),
        node([0.0, -38.0, 98.0], 18.0, 1.2),
        node([0.0, -46.0, 112.0], 14.0, 1.1),
    ];
    let first = nodes.len();
    nodes.extend(man(human::spine_nodes()));
    let mut joints =
        vec![Joint::ball(1, 24.0, 24.0, [4.0, 2.0, 6.0]), Joint::ball(4, 16.0, 12.0, [5.0, 4.0, 8.0])];
    joints.extend(human::spine_joints(first));
    let spine = skeleton.chain(None, nodes, joints);
    let arms = skeleton.pair((spine, first + 2), man(human::arm_nodes()), human::arm_joints());
    let tail_nodes: Vec<_> = std::iter::once(node([0.0, 52.0, 100.0], 10.0, 1.0))
        .chain(TAIL.iter().zip([0.75, 0.7, 0.7, 0.68, 0.55]).map(|(&p, grain)| node(p, 6.0, grain)))
        .collect();
    let tail_joints: Vec<_> = (1..5).map(|i| Joint::ball(i, 7.0, 9.0, [10.0, 0.0, 12.0])).collect();
    let tail = skeleton.chain(Some((spine, 0)), tail_nodes, tail_joints);
    let sideways = [1.0, 0.0, 0.0];
    let down = [0.0, 0.0, -1.0];
    let forelegs = skeleton.pair(
        (spine, 3),
        vec![
            node([8.0, -38.0, 98.0], 13.0, 1.2),
            node([11.0, -43.0, 82.0], 11.5, 1.1),
            node([12.0, -41.5, 64.0], 8.2, 0.95),
            node([12.5, -42.0, 39.5], 4.9, 0.7),
            node([12.5, -41.8, 13.5], 4.0, 0.6),
            node([12.7, -49.0, 3.0], 4.8, 0.55),
        ],
        vec![
            Joint::ball(1, 12.0, 14.0, [8.0, 3.0, 3.0]),
            Joint::hinge(2, 10.0, 10.0, sideways, down, 8.0),
            Joint::hinge(3, 8.0, 7.0, sideways, down, 10.0),
            Joint::hinge(4, 5.0, 5.0, sideways, down, 10.0),
        ],
    );
    let hindlegs = skeleton.pair(
        (spine, 0),
        vec![
            node([7.0, 46.0, 96.0], 16.0, 1.2),
            node([11.0, 44.0, 86.0], 15.5, 1.15),
            node([13.0, 39.5, 68.5], 11.0, 1.0),
            node([13.0, 55.0, 45.5], 5.4, 0.75),
            node([13.0, 53.0, 13.5], 4.2, 0.6),
            node([12.7, 45.5, 3.0], 4.8, 0.55),
        ],
        vec![
            Joint::ball(1, 8.0, 17.0, [8.0, 2.0, 3.0]),
            Joint::hinge(2, 11.0, 11.0, sideways, down, 6.0),
            Joint::hinge(3, 9.0, 8.0, sideways, down, 8.0),
            Joint::hinge(4, 5.0, 5.0, sideways, down, 10.0),
        ],
    );
    let at = |chain, joint| JointId { chain, joint };
    let both = |pair: [usize; 2], joint| pair.map(|chain| at(chain, joint));
    let joints = Joints {
        loin: at(spine, 0),
        withers: at(spine, 1),
        waist: at(spine, 2),
        chest: at(spine, 3),
        neck: at(spine, 4),
        tail: [0, 1, 2, 3].map(|i| at(tail, i)),
        arm_shoulder: both(arms, 0),
        arm_elbow: both(arms, 1),
        fingers: both(arms, 3),
        shoulder: both(forelegs, 0),
        elbow: both(forelegs, 1),
        knee: both(forelegs, 2),
        fetlock: both(forelegs, 3),
        hip: both(hindlegs, 0),
        stifle: both(hindlegs, 1),
        hock: both(hindlegs, 2),
        hind_fetlock: both(hindlegs, 3),
    };
    (skeleton, joints)
}

/// A turn about `x` alone.
fn flex(x: f64) -> Turn {
    turn(x, 0.0, 0.0)
}

fn poses(skeleton: &Skeleton, j: &Joints) -> Vec<Pose> {
    let rest = || Pose::rest(skeleton);
    let legs = |pose: Pose, fore: [[f64; 4]; 2], hind: [[f64; 4]; 2]| {
        pose.both(j.shoulder, fore.map(|t| turn(t[0], -3.0, 0.0)))
            .both(j.elbow, fore.map(|t| flex(t[1])))
            .both(j.knee, fore.map(|t| flex(t[2])))
            .both(j.fetlock, fore.map(|t| flex(t[3])))
            .both(j.hip, hind.map(|t| turn(t[0], -3.0, 0.0)))
            .both(j.stifle, hind.map(|t| flex(t[1])))
            .both(j.hock, hind.map(|t| flex(t[2])))
            .both(j.hind_fetlock, hind.map(|t| flex(t[3])))
    };
    let tail = |pose: Pose, up: [f64; 4], left: [f64; 4]| {
        (0..4).fold(pose, |pose, i| pose.set(j.tail[i], turn(up[i], 0.0, -left[i])))
    };
    let down = 48.0;
    vec![
        rest(),
        // Galloping.
        tail(
            legs(
                rest().root(flex(-8.0)),
                [[-42.0, -18.0, 26.0, 12.0], [-26.0, -32.0, 88.0, 34.0]],
                [[26.0, -18.0, 22.0, 20.0], [18.0, -12.0, 16.0, 20.0]],
            ),
            [48.0, 20.0, 10.0, 4.0],
            [0.0; 4],
        )
        .set(j.withers, flex(14.0))
        .set(j.waist, turn(10.0, 0.0, 14.0))
        .both(j.arm_shoulder, [turn(44.0, down, 0.0), turn(-50.0, down, 0.0)])
        .same(j.arm_elbow, flex(88.0))
        .same(j.fingers, flex(60.0)),
        // Rearing.
        tail(
            legs(
                rest().root(flex(-44.0)),
                [[-10.0, -36.0, 100.0, 36.0], [-30.0, -28.0, 76.0, 30.0]],
                [[24.0, 14.0, 4.0, 4.0], [18.0, 16.0, 6.0, 4.0]],
            ),
            [30.0, 14.0, 6.0, 0.0],
            [8.0; 4],
        )
        .set(j.withers, flex(18.0))
        .both(j.arm_shoulder, [turn(0.0, -80.0, -10.0), turn(-60.0, 30.0, 0.0)])
        .both(j.arm_elbow, [flex(24.0), flex(84.0)])
        .set(j.neck, flex(-12.0)),
        // Kicking out behind.
        tail(
            legs(
                rest().root(flex(38.0)),
                [[-44.0, -6.0, 10.0, 0.0], [-34.0, -8.0, 12.0, 0.0]],
                [[52.0, -26.0, 26.0, 24.0], [40.0, -6.0, -16.0, 30.0]],
            ),
            [54.0, 20.0, 8.0, 0.0],
            [14.0; 4],
        )
        .set(j.loin, flex(-10.0))
        .set(j.withers, flex(-34.0))
        .same(j.arm_shoulder, turn(0.0, -16.0, 18.0))
        .both(j.arm_elbow, [flex(28.0), flex(46.0)])
        .set(j.neck, turn(-12.0, 0.0, 18.0)),
        // Drawing a bow, turned to the side.
        tail(
            legs(
                rest(),
                [[-24.0, -6.0, 8.0, 0.0], [14.0, -10.0, 18.0, 8.0]],
                [[18.0, -6.0, 8.0, 4.0], [-16.0, 12.0, -12.0, 0.0]],
            ),
            [14.0, 6.0, 0.0, 0.0],
            [-16.0; 4],
        )
        .set(j.loin, turn(0.0, 0.0, -16.0))
        .set(j.waist, turn(0.0, 0.0, -40.0))
        .set(j.chest, turn(0.0, 0.0, -26.0))
        .set(j.neck, turn(0.0, 0.0, 52.0))
        .both(j.arm_shoulder, [turn(0.0, -30.0, -14.0), turn(0.0, -28.0, -10.0)])
        .both(j.arm_elbow, [flex(6.0), flex(126.0)])
        .same(j.fingers, flex(70.0)),
        // Bending down, one hoof lifted.
        tail(
            legs(
                rest(),
                [[-58.0, -10.0, 98.0, 34.0], [6.0, -2.0, 0.0, 0.0]],
                [[-14.0, 8.0, -8.0, 0.0], [16.0, -6.0, 8.0, 4.0]],
            ),
            [36.0, 18.0, 0.0, -8.0],
            [24.0, 14.0, 12.0, 0.0],
        )
        .set(j.withers, flex(12.0))
        .set(j.waist, turn(42.0, 0.0, 16.0))
        .set(j.chest, turn(22.0, 0.0, 10.0))
        .set(j.neck, turn(-26.0, 0.0, 14.0))
        .both(j.arm_shoulder, [turn(-64.0, 30.0, 0.0), turn(-20.0, 14.0, -40.0)])
        .both(j.arm_elbow, [flex(34.0), flex(60.0)]),
    ]
}
