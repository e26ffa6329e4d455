//! David: a man, standing, walking, sitting.
//!
//! Centimetres; `z` up, facing `-y`, his left at `x > 0`. Angles in degrees. For legs and hanging arms
//! a negative `x` swings forwards; knees and elbows flex with positive `x`. For raised arms a positive
//! `y` lowers the arm and a negative `z` swings it forwards.

use crate::human;
use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, Turn, turn};
use crate::skeleton::{Joint, JointId, JointPair, Skeleton, node};

/// The family's model.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, area: 17_950.0, spacing: 0.9 }
}

fn body() -> Body {
    let mut parts = vec![pelvis()];
    parts.extend(human::parts());
    parts.push(leg());
    parts.push(foot());
    Body::new(parts)
}

fn pelvis() -> Part {
    Part::added(
        0.0,
        vec![
            Blob::cone([0.0, 0.6, 94.5], 9.4, [5.4, 0.8, 93.5], 9.3),
            Blob::cone([4.6, 0.4, 94.0], 9.3, [4.2, -0.1, 104.0], 8.9).blend(1.5),
            // Buttocks.
            Blob::ball([6.2, 6.0, 89.5], 7.6).blend(2.5),
        ],
    )
}

fn leg() -> Part {
    Part::added(
        4.0,
        vec![
            Blob::cone([9.0, 0.8, 87.0], 8.6, [11.0, -0.4, 50.0], 5.1),
            // Thigh muscles.
            Blob::cone([10.2, -2.2, 74.0], 6.6, [11.2, -2.2, 58.0], 4.8).blend(2.0),
            Blob::cone([9.6, 2.6, 76.0], 6.2, [11.0, 1.6, 58.0], 4.4).blend(2.0),
            Blob::ball([11.2, -2.6, 48.5], 3.9).blend(2.0),
            // Shin and calf.
            Blob::cone([11.1, -0.2, 50.0], 5.0, [13.0, 1.4, 8.0], 3.1).blend(0.6),
            Blob::cone([11.2, 2.4, 41.0], 4.6, [12.0, 2.4, 31.0], 4.0).blend(3.0),
        ],
    )
}

fn foot() -> Part {
    Part::added(
        3.0,
        vec![
            Blob::ball([13.0, 4.6, 3.6], 3.6),
            Blob::cone([13.0, 2.0, 5.4], 3.8, [14.2, -9.5, 2.9], 3.2).blend(1.5),
            Blob::cone([13.6, -8.0, 2.6], 4.6, [14.4, -12.5, 2.2], 4.4)
                .flat([0.0, 0.0, 1.0], 0.55)
                .blend(2.0),
            // Big toe and the row of the others.
            Blob::cone([12.0, -12.0, 1.9], 1.8, [12.0, -18.0, 1.7], 1.55).blend(0.8),
            Blob::cone([14.4, -13.5, 1.8], 1.5, [14.6, -17.0, 1.5], 1.25).blend(0.7),
            Blob::cone([16.4, -12.5, 1.7], 1.5, [17.0, -15.6, 1.4], 1.2).blend(0.7),
        ],
    )
}

struct Joints {
    /// Waist, chest, neck: `x` forwards, `y` sideways, `z` turns to his left.
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
    let sideways = [1.0, 0.0, 0.0];
    let down = [0.0, 0.0, -1.0];
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
        Joint::hinge(2, 11.0, 11.0, sideways, down, 8.0),
        Joint::hinge(3, 5.0, 6.0, sideways, down, 8.0),
    ];
    let legs = skeleton.pair((spine, 0), leg_nodes, leg_joints);
    let at = |chain, joint| JointId { chain, joint };
    let both = |pair: [usize; 2], joint| pair.map(|chain| at(chain, joint));
    let joints = Joints {
        waist: at(spine, 0),
        chest: at(spine, 1),
        neck: at(spine, 2),
        shoulder: both(arms, 0),
        elbow: both(arms, 1),
        wrist: both(arms, 2),
        fingers: both(arms, 3),
        hip: both(legs, 0),
        knee: both(legs, 1),
        ankle: both(legs, 2),
    };
    (skeleton, joints)
}

/// A turn about `x` alone.
fn flex(x: f64) -> Turn {
    turn(x, 0.0, 0.0)
}

fn poses(skeleton: &Skeleton, j: &Joints) -> Vec<Pose> {
    let rest = || Pose::rest(skeleton);
    let down = 48.0;
    vec![
        rest(),
        // Walking.
        rest()
            .both(j.hip, [turn(-28.0, -3.0, 0.0), turn(22.0, -3.0, 0.0)])
            .both(j.knee, [flex(12.0), flex(32.0)])
            .both(j.ankle, [flex(-6.0), flex(18.0)])
            .both(j.shoulder, [turn(26.0, down, 0.0), turn(-30.0, down, 0.0)])
            .same(j.elbow, flex(28.0))
            .set(j.chest, turn(0.0, 0.0, 10.0)),
        // Running.
        rest()
            .root(turn(10.0, 0.0, 0.0))
            .both(j.hip, [turn(-68.0, -4.0, 0.0), turn(28.0, -4.0, 0.0)])
            .both(j.knee, [flex(78.0), flex(68.0)])
            .both(j.ankle, [flex(-8.0), flex(30.0)])
            .both(j.shoulder, [turn(45.0, down, 0.0), turn(-40.0, down, 0.0)])
            .same(j.elbow, flex(80.0))
            .same(j.fingers, flex(45.0))
            .set(j.chest, turn(6.0, 0.0, 16.0)),
        // Sitting.
        rest()
            .same(j.hip, turn(-82.0, -6.0, 0.0))
            .same(j.knee, flex(82.0))
            .same(j.shoulder, turn(-32.0, down, 0.0))
            .same(j.elbow, flex(38.0))
            .set(j.waist, flex(8.0)),
        // Both arms up.
        rest()
            .same(j.shoulder, turn(0.0, -95.0, 0.0))
            .same(j.elbow, flex(12.0))
            .set(j.neck, flex(-20.0))
            .both(j.hip, [turn(-6.0, -12.0, 0.0), turn(4.0, -10.0, 0.0)]),
        // Reaching forwards.
        rest()
            .both(j.shoulder, [turn(0.0, -26.0, -72.0), turn(20.0, down, 0.0)])
            .both(j.elbow, [flex(8.0), flex(40.0)])
            .both(j.hip, [turn(-38.0, -5.0, 0.0), turn(18.0, -5.0, 0.0)])
            .both(j.knee, [flex(46.0), flex(10.0)])
            .set(j.waist, turn(18.0, 0.0, -12.0)),
        // Waving, the other hand on the hip.
        rest()
            .both(j.shoulder, [turn(0.0, -45.0, -10.0), turn(12.0, 26.0, 0.0)])
            .both(j.elbow, [turn(75.0, -80.0, 0.0), turn(85.0, 50.0, 0.0)])
            .set(j.neck, turn(0.0, 8.0, 22.0))
            .both(j.hip, [turn(0.0, -10.0, 0.0), turn(-4.0, -4.0, 0.0)]),
        // Kneeling on one knee.
        rest()
            .both(j.hip, [turn(-84.0, -6.0, 0.0), turn(6.0, -4.0, 0.0)])
            .both(j.knee, [flex(86.0), flex(92.0)])
            .both(j.ankle, [flex(0.0), flex(30.0)])
            .both(j.shoulder, [turn(-48.0, down, 0.0), turn(10.0, down - 6.0, 0.0)])
            .both(j.elbow, [flex(30.0), flex(25.0)]),
        // Kicking.
        rest()
            .root(turn(-10.0, 0.0, 0.0))
            .both(j.hip, [turn(-78.0, -4.0, 0.0), turn(8.0, -4.0, 0.0)])
            .both(j.knee, [flex(14.0), flex(16.0)])
            .both(j.ankle, [flex(24.0), flex(-4.0)])
            .both(j.shoulder, [turn(20.0, 5.0, 24.0), turn(0.0, -6.0, -38.0)])
            .both(j.elbow, [flex(30.0), flex(50.0)]),
        // Squatting, arms forwards.
        rest()
            .root(turn(14.0, 0.0, 0.0))
            .same(j.hip, turn(-92.0, -14.0, 0.0))
            .same(j.knee, flex(100.0))
            .same(j.ankle, flex(-16.0))
            .same(j.shoulder, turn(0.0, -22.0, -66.0))
            .same(j.elbow, flex(14.0))
            .set(j.neck, flex(-10.0)),
        // Throwing.
        rest()
            .both(j.shoulder, [turn(0.0, -52.0, 28.0), turn(0.0, -8.0, -62.0)])
            .both(j.elbow, [turn(62.0, -70.0, 0.0), flex(22.0)])
            .both(j.hip, [turn(24.0, -6.0, 0.0), turn(-34.0, -6.0, 0.0)])
            .both(j.knee, [flex(24.0), flex(30.0)])
            .set(j.waist, turn(-10.0, 0.0, 26.0))
            .set(j.neck, turn(0.0, 0.0, -24.0)),
        // Bowing.
        rest()
            .set(j.waist, flex(48.0))
            .set(j.chest, flex(22.0))
            .set(j.neck, flex(14.0))
            .same(j.shoulder, turn(-30.0, down, 0.0))
            .same(j.elbow, flex(15.0))
            .same(j.hip, turn(-10.0, -3.0, 0.0))
            .same(j.knee, flex(12.0)),
        // Boxing.
        rest()
            .both(j.shoulder, [turn(-30.0, 34.0, -10.0), turn(-52.0, 30.0, 0.0)])
            .both(j.elbow, [flex(108.0), flex(70.0)])
            .same(j.fingers, flex(75.0))
            .both(j.hip, [turn(-26.0, -8.0, 0.0), turn(16.0, -8.0, 0.0)])
            .both(j.knee, [flex(30.0), flex(24.0)])
            .set(j.waist, turn(8.0, 0.0, 22.0)),
        // Climbing.
        rest()
            .both(j.shoulder, [turn(0.0, -92.0, -24.0), turn(-55.0, 30.0, 0.0)])
            .both(j.elbow, [flex(16.0), flex(80.0)])
            .both(j.hip, [turn(8.0, -6.0, 0.0), turn(-88.0, -20.0, 0.0)])
            .both(j.knee, [flex(14.0), flex(88.0)])
            .set(j.neck, turn(-22.0, 0.0, 10.0)),
        // Standing at ease, looking aside.
        rest()
            .same(j.shoulder, turn(6.0, down, 0.0))
            .same(j.elbow, flex(18.0))
            .same(j.wrist, flex(8.0))
            .both(j.hip, [turn(-8.0, -10.0, -8.0), turn(4.0, -3.0, 0.0)])
            .both(j.knee, [flex(14.0), flex(2.0)])
            .set(j.waist, turn(0.0, 5.0, 8.0))
            .set(j.neck, turn(0.0, 0.0, 38.0)),
    ]
}
