//! David: a man, standing, walking, sitting.
//!
//! Lengths are in centimetres, `z` is up, he faces `-y`, and his left is at `x > 0`. Angles are in degrees. A
//! negative `x` swings legs and hanging arms forwards; a positive `x` flexes knees and elbows. A positive `y`
//! lowers a raised arm, and a negative `z` swings it forwards.

use crate::human;
use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, flex, turn};
use crate::skeleton::{Joint, JointId, JointPair, Skeleton, joint_pairs, joints, node};

/// The model of the family.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, genus: 0, area: 17_950.0, spacing: 0.9 }
}

fn body() -> Body {
    let mut parts = vec![pelvis()];
    parts.extend(human::parts());
    parts.push(leg());
    parts.push(foot());
    Body::new(parts)
}

fn pelvis() -> Part {
    Part::added(vec![
        Blob::cone([0.0, 0.6, 94.5], 9.4, [5.4, 0.8, 93.5], 9.3),
        Blob::cone([4.6, 0.4, 94.0], 9.3, [4.2, -0.1, 104.0], 8.9).blend(1.5),
        // Buttocks.
        Blob::ball([6.2, 6.0, 89.5], 7.6).blend(2.5),
    ])
}

fn leg() -> Part {
    Part::added(vec![
        Blob::cone([9.0, 0.8, 87.0], 8.6, [11.0, -0.4, 50.0], 5.1),
        // Thigh muscles.
        Blob::cone([10.2, -2.2, 74.0], 6.6, [11.2, -2.2, 58.0], 4.8).blend(2.0),
        Blob::cone([9.6, 2.6, 76.0], 6.2, [11.0, 1.6, 58.0], 4.4).blend(2.0),
        Blob::ball([11.2, -2.6, 48.5], 3.9).blend(2.0),
        // Shin and calf.
        Blob::cone([11.1, -0.2, 50.0], 5.0, [13.0, 1.4, 8.0], 3.1).blend(0.6),
        Blob::cone([11.2, 2.4, 41.0], 4.6, [12.0, 2.4, 31.0], 4.0).blend(3.0),
    ])
    .blend(4.0)
}

fn foot() -> Part {
    Part::added(vec![
        Blob::ball([13.0, 4.6, 3.6], 3.6),
        Blob::cone([13.0, 2.0, 5.4], 3.8, [14.2, -9.5, 2.9], 3.2).blend(1.5),
        Blob::cone([13.6, -8.0, 2.6], 4.6, [14.4, -12.5, 2.2], 4.4).flat([0.0, 0.0, 1.0], 0.55).blend(2.0),
        // Big toe and the row of the others.
        Blob::cone([12.0, -12.0, 1.9], 1.8, [12.0, -18.0, 1.7], 1.55).blend(0.8),
        Blob::cone([14.4, -13.5, 1.8], 1.5, [14.6, -17.0, 1.5], 1.25).blend(0.7),
        Blob::cone([16.4, -12.5, 1.7], 1.5, [17.0, -15.6, 1.4], 1.2).blend(0.7),
    ])
    .blend(3.0)
}

struct Joints {
    /// For waist, chest and neck, `x` bends forwards, `y` sideways, and `z` turns to the left.
    waist: JointId,
    chest: JointId,
    neck: JointId,
    shoulder: JointPair,
    elbow: JointPair,
    wrist: JointPair,
    fingers: JointPair,
    hip: JointPair,
    knee: JointPair,
    ankle: JointPair,
}

fn skeleton() -> (Skeleton, Joints) {
    let mut skeleton = Skeleton::default();
    let mut nodes = vec![node([0.0, 0.0, 93.0], 13.0, 1.15)];
    nodes.extend(human::spine_nodes());
    let spine = skeleton.chain(None, nodes, human::spine_joints(1));
    let arms = skeleton.pair((spine, 3), human::arm_nodes(), human::arm_joints());
    let leg_nodes = vec![
        node([4.0, -1.0, 94.0], 11.0, 1.1),
        node([9.0, -3.5, 88.0], 9.5, 1.0),
        node([11.0, 2.2, 48.5], 5.5, 0.85),
        node([13.0, 0.4, 8.0], 3.9, 0.58),
        node([13.6, -6.5, 3.2], 3.8, 0.5),
        node([14.4, -16.0, 1.8], 3.2, 0.36),
    ];
    let leg_joints = vec![
        Joint::ball(1, 5.0, 17.0, [10.0, 2.5, 6.0]),
        Joint::leg(2, 11.0, 11.0, 8.0),
        Joint::leg(3, 5.0, 6.0, 8.0),
    ];
    let legs = skeleton.pair((spine, 0), leg_nodes, leg_joints);
    let ([waist, chest, neck], [hip, knee, ankle]) = (joints(spine), joint_pairs(legs));
    let [shoulder, elbow, wrist, fingers] = joint_pairs(arms);
    (skeleton, Joints { waist, chest, neck, shoulder, elbow, wrist, fingers, hip, knee, ankle })
}

fn poses(skeleton: &Skeleton, j: &Joints) -> Vec<Pose> {
    let rest = || Pose::rest(skeleton);
    let down = 48.0;
    vec![
        rest(),
        // Striding.
        rest()
            .both(j.hip, [turn(-44.0, -3.0, 0.0), turn(30.0, -3.0, 0.0)])
            .both(j.knee, [flex(20.0), flex(46.0)])
            .both(j.ankle, [flex(-8.0), flex(26.0)])
            .both(j.shoulder, [turn(40.0, down, 0.0), turn(-46.0, down, 0.0)])
            .same(j.elbow, flex(42.0))
            .set(j.chest, turn(0.0, 0.0, 16.0)),
        // Sprinting.
        rest()
            .root(turn(16.0, 0.0, 0.0))
            .both(j.hip, [turn(-94.0, -4.0, 0.0), turn(32.0, -4.0, 0.0)])
            .both(j.knee, [flex(102.0), flex(96.0)])
            .both(j.ankle, [flex(-10.0), flex(36.0)])
            .both(j.shoulder, [turn(58.0, down, 0.0), turn(-58.0, down, 0.0)])
            .same(j.elbow, flex(98.0))
            .same(j.fingers, flex(60.0))
            .set(j.chest, turn(8.0, 0.0, 20.0)),
        // Sitting on the ground, leaning back on his hands.
        rest()
            .root(turn(-32.0, 0.0, 0.0))
            .both(j.hip, [turn(-84.0, -12.0, 0.0), turn(-62.0, -8.0, 0.0)])
            .both(j.knee, [flex(92.0), flex(14.0)])
            .both(j.ankle, [flex(20.0), flex(14.0)])
            .same(j.shoulder, turn(54.0, 30.0, 0.0))
            .same(j.elbow, flex(8.0))
            .same(j.wrist, flex(-30.0))
            .set(j.waist, flex(16.0))
            .set(j.neck, turn(14.0, 0.0, 20.0)),
        // Jumping, all limbs spread.
        rest()
            .same(j.shoulder, turn(0.0, -84.0, 0.0))
            .same(j.elbow, flex(12.0))
            .set(j.neck, flex(-24.0))
            .set(j.waist, flex(-12.0))
            .both(j.hip, [turn(10.0, -36.0, 0.0), turn(-18.0, -34.0, 0.0)])
            .both(j.knee, [flex(26.0), flex(40.0)])
            .same(j.ankle, flex(28.0)),
        // Lunging, one arm forwards.
        rest()
            .both(j.shoulder, [turn(0.0, -28.0, -84.0), turn(44.0, down, 0.0)])
            .both(j.elbow, [flex(8.0), flex(52.0)])
            .both(j.hip, [turn(-86.0, -8.0, 0.0), turn(34.0, -6.0, 0.0)])
            .both(j.knee, [flex(84.0), flex(16.0)])
            .both(j.ankle, [flex(0.0), flex(24.0)])
            .set(j.waist, turn(26.0, 0.0, -18.0))
            .set(j.neck, flex(-20.0)),
        // Waving, the other hand on the hip.
        rest()
            .both(j.shoulder, [turn(0.0, -56.0, -10.0), turn(16.0, 26.0, 0.0)])
            .both(j.elbow, [turn(84.0, -80.0, 0.0), turn(96.0, 50.0, 0.0)])
            .set(j.waist, turn(0.0, 14.0, 0.0))
            .set(j.neck, turn(0.0, 10.0, 34.0))
            .both(j.hip, [turn(0.0, -22.0, 0.0), turn(-8.0, -4.0, 0.0)]),
        // Crouching at the start of a race, hands to the ground.
        rest()
            .root(turn(52.0, 0.0, 0.0))
            .both(j.hip, [turn(-112.0, -8.0, 0.0), turn(-64.0, -6.0, 0.0)])
            .both(j.knee, [flex(112.0), flex(104.0)])
            .both(j.ankle, [flex(-6.0), flex(10.0)])
            .same(j.shoulder, turn(-70.0, 34.0, 0.0))
            .same(j.elbow, flex(8.0))
            .set(j.waist, flex(24.0))
            .set(j.chest, flex(12.0))
            .set(j.neck, flex(-34.0)),
        // Kicking high.
        rest()
            .root(turn(-22.0, 0.0, 0.0))
            .both(j.hip, [turn(-106.0, -6.0, 0.0), turn(18.0, -6.0, 0.0)])
            .both(j.knee, [flex(10.0), flex(24.0)])
            .both(j.ankle, [flex(28.0), flex(-4.0)])
            .both(j.shoulder, [turn(30.0, 8.0, 30.0), turn(0.0, -10.0, -50.0)])
            .both(j.elbow, [flex(44.0), flex(70.0)])
            .set(j.waist, flex(14.0)),
        // Squatting, arms forwards.
        rest()
            .root(turn(24.0, 0.0, 0.0))
            .same(j.hip, turn(-112.0, -20.0, 0.0))
            .same(j.knee, flex(124.0))
            .same(j.ankle, flex(-22.0))
            .same(j.shoulder, turn(0.0, -28.0, -74.0))
            .same(j.elbow, flex(14.0))
            .set(j.neck, flex(-18.0)),
        // Throwing.
        rest()
            .both(j.shoulder, [turn(0.0, -60.0, 38.0), turn(0.0, -12.0, -70.0)])
            .both(j.elbow, [turn(80.0, -70.0, 0.0), flex(30.0)])
            .both(j.hip, [turn(34.0, -8.0, 0.0), turn(-56.0, -8.0, 0.0)])
            .both(j.knee, [flex(36.0), flex(44.0)])
            .set(j.waist, turn(-16.0, 0.0, 32.0))
            .set(j.chest, turn(-6.0, 0.0, 14.0))
            .set(j.neck, turn(0.0, 0.0, -36.0)),
        // Bending down to his toes.
        rest()
            .root(turn(34.0, 0.0, 0.0))
            .same(j.hip, turn(-46.0, -4.0, 0.0))
            .same(j.knee, flex(14.0))
            .set(j.waist, flex(48.0))
            .set(j.chest, flex(26.0))
            .set(j.neck, flex(18.0))
            .same(j.shoulder, turn(-74.0, down - 4.0, 0.0))
            .same(j.elbow, flex(10.0)),
        // Boxing, ducked.
        rest()
            .both(j.shoulder, [turn(-44.0, 34.0, -14.0), turn(-68.0, 26.0, 0.0)])
            .both(j.elbow, [flex(116.0), flex(64.0)])
            .same(j.fingers, flex(80.0))
            .both(j.hip, [turn(-58.0, -12.0, 0.0), turn(-14.0, -12.0, 0.0)])
            .both(j.knee, [flex(66.0), flex(58.0)])
            .set(j.waist, turn(26.0, 0.0, 28.0))
            .set(j.chest, turn(12.0, 0.0, 8.0))
            .set(j.neck, turn(-20.0, 0.0, -20.0)),
        // Climbing.
        rest()
            .both(j.shoulder, [turn(0.0, -92.0, -24.0), turn(-70.0, 24.0, 0.0)])
            .both(j.elbow, [flex(16.0), flex(96.0)])
            .both(j.hip, [turn(12.0, -6.0, 0.0), turn(-108.0, -22.0, 0.0)])
            .both(j.knee, [flex(16.0), flex(112.0)])
            .set(j.waist, turn(0.0, -12.0, 0.0))
            .set(j.neck, turn(-30.0, 0.0, 14.0)),
        // Asleep on his side, curled up.
        rest()
            .root(turn(0.0, 84.0, 0.0))
            .both(j.hip, [turn(-76.0, -4.0, 0.0), turn(-60.0, -6.0, 0.0)])
            .both(j.knee, [flex(96.0), flex(84.0)])
            .same(j.ankle, flex(20.0))
            .both(j.shoulder, [turn(-56.0, 38.0, 0.0), turn(-74.0, 32.0, 0.0)])
            .both(j.elbow, [flex(70.0), flex(96.0)])
            .set(j.waist, flex(26.0))
            .set(j.chest, flex(18.0))
            .set(j.neck, flex(22.0)),
    ]
}
