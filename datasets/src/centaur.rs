//! A centaur: a horse with the trunk, arms and head of a man in place of its neck.
//!
//! Lengths are in centimetres, `z` is up, it faces `-y`, and its left is at `x > 0`. Angles are in degrees,
//! with the signs of the cat for legs, trunk and tail, and of david for arms and neck.

use crate::human;
use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, flex, turn};
use crate::skeleton::{Joint, JointId, JointPair, Node, Skeleton, joint_pairs, joints, node};

/// Size and offset of the man: his navel is above the shoulders of the horse.
const MAN_SCALE: f64 = 1.0;
const MAN_OFFSET: [f64; 3] = [0.0, -46.0, 14.0];
/// The man is small compared with the horse, so that his hands and face need smaller triangles.
const MAN_GRAIN: f64 = 0.7;

/// The model of the family.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, genus: 0, area: 41_250.0, spacing: 1.0 }
}

fn body() -> Body {
    let mut parts = vec![barrel()];
    parts.extend(human::parts().iter().map(|part| part.moved(MAN_SCALE, MAN_OFFSET)));
    parts.extend([foreleg(), hindleg(), hoof(-48.0), hoof(47.0), ground(), tail()]);
    Body::new(parts)
}

fn barrel() -> Part {
    let sideways = [1.0, 0.0, 0.0];
    Part::added(vec![
        Blob::cone([0.0, -34.0, 93.0], 23.0, [0.0, 6.0, 92.0], 24.0).flat(sideways, 0.84),
        Blob::cone([0.0, 6.0, 92.0], 24.0, [0.0, 40.0, 95.0], 21.5).flat(sideways, 0.84).blend(1.0),
        // Croup and breast.
        Blob::cone([0.0, 40.0, 96.0], 21.5, [0.0, 52.0, 97.0], 18.0).flat(sideways, 0.9).blend(3.0),
        Blob::cone([0.0, -44.0, 92.0], 18.5, [0.0, -46.0, 112.0], 13.5).flat(sideways, 0.95).blend(5.0),
    ])
}

fn foreleg() -> Part {
    Part::added(vec![
        Blob::cone([10.0, -38.0, 98.0], 11.5, [11.5, -46.0, 82.0], 11.5),
        Blob::cone([11.5, -46.0, 82.0], 11.0, [12.0, -41.0, 64.0], 8.0).blend(2.0),
        Blob::cone([12.0, -41.0, 64.0], 7.8, [12.5, -43.0, 40.0], 4.8).blend(1.5),
        Blob::ball([12.5, -43.6, 39.0], 5.0).blend(1.5),
        Blob::cone([12.5, -43.0, 38.0], 4.2, [12.5, -42.0, 14.0], 3.6).blend(1.0),
        Blob::ball([12.5, -41.6, 13.0], 4.2).blend(1.5),
        Blob::cone([12.5, -42.0, 13.0], 3.6, [12.5, -46.0, 6.0], 3.8).blend(1.0),
    ])
    .blend(6.0)
}

fn hindleg() -> Part {
    Part::added(vec![
        Blob::cone([10.5, 44.0, 92.0], 17.0, [13.0, 38.0, 70.0], 11.5),
        Blob::cone([13.0, 38.0, 69.0], 10.5, [13.0, 56.0, 45.0], 5.0).blend(2.5),
        Blob::ball([13.0, 56.6, 44.5], 5.0).blend(1.5),
        Blob::cone([13.0, 56.0, 44.0], 4.6, [13.0, 53.0, 14.0], 3.8).blend(1.0),
        Blob::ball([13.0, 53.4, 13.0], 4.3).blend(1.5),
        Blob::cone([13.0, 53.0, 13.0], 3.8, [12.8, 49.0, 6.0], 3.9).blend(1.0),
    ])
    .blend(7.0)
}

fn hoof(y: f64) -> Part {
    Part::added(vec![Blob::cone([12.7, y + 1.0, 7.5], 3.9, [12.7, y - 1.2, 1.0], 5.6)]).blend(1.0)
}

/// The hooves are flat below: the top of a very large ball is the ground.
fn ground() -> Part {
    const RADIUS: f64 = 2000.0;
    Part::carved(vec![Blob::ball([0.0, 0.0, 0.4 - RADIUS], RADIUS)]).blend(0.8)
}

/// The axis of the tail at rest.
const TAIL: [[f64; 3]; 5] =
    [[0.0, 68.0, 103.0], [0.0, 78.0, 98.0], [0.0, 85.0, 84.0], [0.0, 89.0, 66.0], [0.0, 91.0, 46.0]];

fn tail() -> Part {
    Part::added(Blob::tube(([0.0, 56.0, 103.0], 6.0), TAIL, [4.4, 5.6, 6.8, 6.4, 2.6])).blend(4.0)
}

struct Joints {
    loin: JointId,
    /// Between the back of the horse and the trunk of the man.
    withers: JointId,
    waist: JointId,
    chest: JointId,
    neck: JointId,
    tail: [JointId; 4],
    arm_shoulder: JointPair,
    arm_elbow: JointPair,
    fingers: JointPair,
    /// Shoulder, elbow, knee, fetlock.
    forelegs: [JointPair; 4],
    /// Hip, stifle, hock, fetlock.
    hindlegs: [JointPair; 4],
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
    let mut spine_joints =
        vec![Joint::ball(1, 24.0, 24.0, [4.0, 2.0, 6.0]), Joint::ball(4, 16.0, 12.0, [5.0, 4.0, 8.0])];
    spine_joints.extend(human::spine_joints(first));
    let spine = skeleton.chain(None, nodes, spine_joints);
    let arms = skeleton.pair((spine, first + 2), man(human::arm_nodes()), human::arm_joints());
    let tail = skeleton.tail(
        (spine, 0),
        node([0.0, 52.0, 100.0], 10.0, 1.0),
        TAIL,
        6.0,
        [0.75, 0.7, 0.7, 0.68, 0.55],
        &[[10.0, 0.0, 12.0]; 4],
    );
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
            Joint::leg(2, 10.0, 10.0, 8.0),
            Joint::leg(3, 8.0, 7.0, 10.0),
            Joint::leg(4, 5.0, 5.0, 10.0),
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
            Joint::leg(2, 11.0, 11.0, 6.0),
            Joint::leg(3, 9.0, 8.0, 8.0),
            Joint::leg(4, 5.0, 5.0, 10.0),
        ],
    );
    let ([loin, withers, waist, chest, neck], tail) = (joints(spine), joints(tail));
    let [arm_shoulder, arm_elbow, _, fingers] = joint_pairs(arms);
    let (forelegs, hindlegs) = (joint_pairs(forelegs), joint_pairs(hindlegs));
    let joints = Joints {
        loin,
        withers,
        waist,
        chest,
        neck,
        tail,
        arm_shoulder,
        arm_elbow,
        fingers,
        forelegs,
        hindlegs,
    };
    (skeleton, joints)
}

fn poses(skeleton: &Skeleton, j: &Joints) -> Vec<Pose> {
    let rest = || Pose::rest(skeleton);
    let legs = |pose: Pose, fore, hind| pose.legs(j.forelegs, -3.0, fore).legs(j.hindlegs, -3.0, hind);
    let down = 48.0;
    vec![
        rest(),
        // Galloping.
        legs(
            rest().root(flex(-8.0)),
            [[-42.0, -18.0, 26.0, 12.0], [-26.0, -32.0, 88.0, 34.0]],
            [[26.0, -18.0, 22.0, 20.0], [18.0, -12.0, 16.0, 20.0]],
        )
        .tail(j.tail, [48.0, 20.0, 10.0, 4.0], [0.0; 4])
        .set(j.withers, flex(14.0))
        .set(j.waist, turn(10.0, 0.0, 14.0))
        .both(j.arm_shoulder, [turn(44.0, down, 0.0), turn(-50.0, down, 0.0)])
        .same(j.arm_elbow, flex(88.0))
        .same(j.fingers, flex(60.0)),
        // Rearing.
        legs(
            rest().root(flex(-44.0)),
            [[-10.0, -36.0, 100.0, 36.0], [-30.0, -28.0, 76.0, 30.0]],
            [[24.0, 14.0, 4.0, 4.0], [18.0, 16.0, 6.0, 4.0]],
        )
        .tail(j.tail, [30.0, 14.0, 6.0, 0.0], [8.0; 4])
        .set(j.withers, flex(18.0))
        .both(j.arm_shoulder, [turn(0.0, -80.0, -10.0), turn(-60.0, 30.0, 0.0)])
        .both(j.arm_elbow, [flex(24.0), flex(84.0)])
        .set(j.neck, flex(-12.0)),
        // Kicking out behind.
        legs(
            rest().root(flex(38.0)),
            [[-44.0, -6.0, 10.0, 0.0], [-34.0, -8.0, 12.0, 0.0]],
            [[52.0, -26.0, 26.0, 24.0], [40.0, -6.0, -16.0, 30.0]],
        )
        .tail(j.tail, [54.0, 20.0, 8.0, 0.0], [14.0; 4])
        .set(j.loin, flex(-10.0))
        .set(j.withers, flex(-34.0))
        .same(j.arm_shoulder, turn(0.0, -16.0, 18.0))
        .both(j.arm_elbow, [flex(28.0), flex(46.0)])
        .set(j.neck, turn(-12.0, 0.0, 18.0)),
        // Drawing a bow, turned to the side.
        legs(
            rest(),
            [[-24.0, -6.0, 8.0, 0.0], [14.0, -10.0, 18.0, 8.0]],
            [[18.0, -6.0, 8.0, 4.0], [-16.0, 12.0, -12.0, 0.0]],
        )
        .tail(j.tail, [14.0, 6.0, 0.0, 0.0], [-16.0; 4])
        .set(j.loin, turn(0.0, 0.0, -16.0))
        .set(j.waist, turn(0.0, 0.0, -40.0))
        .set(j.chest, turn(0.0, 0.0, -26.0))
        .set(j.neck, turn(0.0, 0.0, 52.0))
        .both(j.arm_shoulder, [turn(0.0, -30.0, -14.0), turn(0.0, -28.0, -10.0)])
        .both(j.arm_elbow, [flex(6.0), flex(126.0)])
        .same(j.fingers, flex(70.0)),
        // Bending down, one hoof lifted.
        legs(
            rest(),
            [[-58.0, -10.0, 98.0, 34.0], [6.0, -2.0, 0.0, 0.0]],
            [[-14.0, 8.0, -8.0, 0.0], [16.0, -6.0, 8.0, 4.0]],
        )
        .tail(j.tail, [36.0, 18.0, 0.0, -8.0], [24.0, 14.0, 12.0, 0.0])
        .set(j.withers, flex(12.0))
        .set(j.waist, turn(42.0, 0.0, 16.0))
        .set(j.chest, turn(22.0, 0.0, 10.0))
        .set(j.neck, turn(-26.0, 0.0, 14.0))
        .both(j.arm_shoulder, [turn(-64.0, 30.0, 0.0), turn(-20.0, 14.0, -40.0)])
        .both(j.arm_elbow, [flex(34.0), flex(60.0)]),
    ]
}
