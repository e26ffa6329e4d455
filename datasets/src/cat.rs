//! A cat: standing, walking, stretching, sitting, hunting.
//!
//! Centimetres of a large cat; `z` up, facing `-y`, its left at `x > 0`. Angles in degrees. For legs a
//! negative `x` swings forwards; for the trunk a positive `x` turns the front end down, for the neck it
//! nods, for the tail a positive `x` curls upwards.

use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, Turn, turn};
use crate::skeleton::{Joint, JointId, JointPair, Skeleton, node};

/// The family's model.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, area: 19_930.0, spacing: 1.4 }
}

fn body() -> Body {
    let mut parts = vec![trunk(), neck(), head()];
    parts.extend(face());
    parts.extend([ear(), ear_hollow(), foreleg(), hindleg(), tail()]);
    Body::new(parts)
}

fn trunk() -> Part {
    let sideways = [1.0, 0.0, 0.0];
    Part::added(
        0.0,
        vec![
            Blob::cone([0.0, -24.0, 57.0], 16.5, [0.0, 4.0, 58.0], 15.6).flat(sideways, 0.80),
            Blob::cone([0.0, 4.0, 58.0], 15.6, [0.0, 26.0, 60.0], 13.8).flat(sideways, 0.80).blend(1.0),
            // Rump and chest.
            Blob::cone([0.0, 26.0, 60.0], 14.2, [0.0, 34.0, 60.0], 12.4).flat(sideways, 0.85).blend(2.0),
            Blob::ball([0.0, -33.0, 56.0], 13.0).flat(sideways, 0.88).blend(4.0),
        ],
    )
}

fn neck() -> Part {
    Part::added(6.0, vec![Blob::cone([0.0, -31.0, 62.0], 12.0, [0.0, -48.0, 75.0], 10.2)])
}

fn head() -> Part {
    Part::added(
        4.0,
        vec![
            Blob::ball([0.0, -54.0, 80.0], 13.4).flat([0.0, 0.0, 1.0], 0.92),
            // Cheeks, muzzle, chin.
            Blob::ball([6.4, -56.0, 76.0], 7.8).blend(4.0),
            Blob::cone([0.0, -61.0, 75.5], 7.4, [0.0, -66.6, 74.0], 5.4).blend(4.0),
            Blob::ball([2.9, -67.8, 73.2], 4.0).blend(1.6),
            Blob::ball([0.0, -66.2, 69.9], 3.4).blend(1.6),
        ],
    )
}

fn face() -> Vec<Part> {
    vec![
        Part::carved(2.0, vec![Blob::ball([5.8, -68.4, 82.0], 3.9)]),
        Part::added(1.0, vec![Blob::ball([5.5, -63.6, 81.8], 2.9)]),
        // Bridge and tip of the nose.
        Part::added(
            2.0,
            vec![
                Blob::cone([0.0, -64.0, 81.0], 2.4, [0.0, -70.2, 76.4], 1.8),
                Blob::ball([0.0, -71.0, 76.0], 1.8).blend(0.8),
            ],
        ),
    ]
}

fn ear() -> Part {
    Part::added(
        3.0,
        vec![Blob::cone([7.4, -51.5, 88.0], 7.4, [11.4, -49.8, 101.5], 2.6).flat([0.28, 1.0, -0.1], 0.52)],
    )
}

fn ear_hollow() -> Part {
    Part::carved(
        1.2,
        vec![Blob::cone([8.6, -57.0, 92.0], 3.9, [10.6, -55.4, 98.5], 1.6).flat([0.28, 1.0, -0.1], 0.6)],
    )
}

fn foreleg() -> Part {
    Part::added(
        5.0,
        vec![
            // Shoulder blade and upper arm lie against the chest.
            Blob::cone([7.6, -22.0, 64.0], 7.0, [8.0, -32.0, 52.0], 8.2),
            Blob::cone([8.0, -32.0, 52.0], 8.0, [8.6, -25.0, 37.0], 5.5).blend(1.0),
            Blob::cone([8.6, -25.0, 37.0], 5.5, [8.8, -28.5, 13.0], 4.0),
            Blob::cone([8.8, -28.5, 13.0], 4.0, [8.8, -29.5, 5.5], 4.3),
            Blob::cone([8.8, -30.5, 4.0], 5.0, [8.8, -34.0, 3.8], 4.9).flat([0.0, 0.0, 1.0], 0.76).blend(1.5),
        ],
    )
}

fn hindleg() -> Part {
    Part::added(
        6.0,
        vec![
            Blob::cone([7.4, 29.0, 58.0], 12.4, [9.4, 23.0, 42.0], 8.0),
            Blob::cone([9.4, 24.0, 42.0], 7.4, [9.8, 38.0, 21.5], 4.0).blend(4.0),
            Blob::cone([9.8, 38.0, 21.5], 4.0, [9.8, 34.0, 6.5], 3.8),
            Blob::cone([9.8, 32.0, 4.2], 4.6, [9.8, 27.0, 3.8], 5.0).flat([0.0, 0.0, 1.0], 0.76).blend(1.5),
        ],
    )
}

/// The axis of the tail at rest.
const TAIL: [[f64; 3]; 6] = [
    [0.0, 42.0, 66.0],
    [0.0, 56.0, 66.5],
    [0.0, 70.0, 65.0],
    [0.0, 84.0, 63.5],
    [0.0, 98.0, 63.0],
    [0.0, 112.0, 64.0],
];

fn tail() -> Part {
    let radii = [5.2, 4.3, 4.0, 3.8, 3.6, 3.0];
    let segment = |i: usize| Blob::cone(TAIL[i], radii[i], TAIL[i + 1], radii[i + 1]);
    let root = Blob::cone([0.0, 34.0, 64.0], 7.0, TAIL[0], radii[0]);
    Part::added(4.0, std::iter::once(root).chain((0..5).map(segment)).collect())
}

struct Joints {
    /// Loins and chest: `x` turns the front down, `z` to its left.
    loin: JointId,
    chest: JointId,
    neck: JointId,
    /// From root to tip.
    tail: [JointId; 5],
    shoulder: JointPair,
    elbow: JointPair,
    wrist: JointPair,
    hip: JointPair,
    knee: JointPair,
    hock: JointPair,
    toes: JointPair,
}

fn skeleton() -> (Skeleton, Joints) {
    let mut skeleton = Skeleton::default();
    let spine = skeleton.chain(
        None,
        vec![
            node([0.0, 32.0, 60.0], 13.0, 1.0),
            node([0.0, 16.0, 59.0], 13.5, 1.1),
            node([0.0, -8.0, 58.0], 14.5, 1.1),
            node([0.0, -28.0, 58.0], 13.0, 1.0),
            node([0.0, -36.0, 65.0], 11.5, 0.85),
            node([0.0, -46.0, 73.0], 10.5, 0.75),
            node([0.0, -54.0, 82.0], 13.0, 0.58),
            node([0.0, -70.0, 76.0], 6.5, 0.34),
        ],
        vec![
            Joint::ball(1, 15.0, 16.0, [5.0, 4.0, 10.0]),
            Joint::ball(2, 8.0, 16.0, [4.0, 4.0, 8.0]),
            Joint::ball(4, 7.0, 16.0, [10.0, 8.0, 22.0]),
        ],
    );
    let tail_nodes: Vec<_> = std::iter::once(node([0.0, 33.0, 63.0], 8.0, 0.8))
        .chain(TAIL.iter().zip([0.62, 0.55, 0.52, 0.5, 0.48, 0.42]).map(|(&p, grain)| node(p, 4.2, grain)))
        .collect();
    let tail_joints: Vec<_> = (1..6)
        .map(|i| {
            let play = if i == 1 { [12.0, 0.0, 12.0] } else { [20.0, 0.0, 20.0] };
            Joint::ball(i, 7.0, 9.0, play)
        })
        .collect();
    let tail = skeleton.chain(Some((spine, 0)), tail_nodes, tail_joints);
    let sideways = [1.0, 0.0, 0.0];
    let down = [0.0, 0.0, -1.0];
    let forelegs = skeleton.pair(
        (spine, 3),
        vec![
            node([6.0, -26.0, 62.0], 8.5, 1.0),
            node([8.0, -29.0, 50.0], 8.0, 0.9),
            node([8.6, -26.0, 37.0], 5.6, 0.75),
            node([8.8, -28.0, 13.0], 4.1, 0.58),
            node([8.8, -30.0, 5.0], 4.6, 0.5),
            node([8.8, -36.0, 3.6], 4.4, 0.42),
        ],
        vec![
            Joint::ball(1, 12.0, 15.0, [7.0, 2.0, 3.0]),
            Joint::hinge(2, 8.0, 8.0, sideways, down, 8.0),
            Joint::hinge(3, 6.0, 6.0, sideways, down, 10.0),
        ],
    );
    let hindlegs = skeleton.pair(
        (spine, 0),
        vec![
            node([5.0, 31.0, 60.0], 11.0, 1.0),
            node([7.6, 29.0, 54.0], 11.5, 0.95),
            node([9.6, 23.5, 40.0], 8.0, 0.8),
            node([9.8, 37.5, 21.5], 4.2, 0.6),
            node([9.8, 34.0, 6.5], 4.0, 0.5),
            node([9.8, 25.0, 3.8], 4.4, 0.42),
        ],
        vec![
            Joint::ball(1, 6.0, 16.0, [7.0, 3.0, 4.0]),
            Joint::hinge(2, 8.0, 8.0, sideways, down, 8.0),
            Joint::hinge(3, 9.0, 8.0, sideways, down, 8.0),
            Joint::hinge(4, 4.0, 6.0, sideways, down, 8.0),
        ],
    );
    // Ears do not move; their chains only ask for small triangles.
    skeleton.pair(
        (spine, 6),
        vec![node([6.5, -52.0, 90.0], 5.0, 0.5), node([11.4, -49.8, 101.5], 3.6, 0.3)],
        Vec::new(),
    );
    let at = |chain, joint| JointId { chain, joint };
    let both = |pair: [usize; 2], joint| pair.map(|chain| at(chain, joint));
    let joints = Joints {
        loin: at(spine, 0),
        chest: at(spine, 1),
        neck: at(spine, 2),
        tail: [0, 1, 2, 3, 4].map(|i| at(tail, i)),
        shoulder: both(forelegs, 0),
        elbow: both(forelegs, 1),
        wrist: both(forelegs, 2),
        hip: both(hindlegs, 0),
        knee: both(hindlegs, 1),
        hock: both(hindlegs, 2),
        toes: both(hindlegs, 3),
    };
    (skeleton, joints)
}

/// A turn about `x` alone.
fn flex(x: f64) -> Turn {
    turn(x, 0.0, 0.0)
}

/// Turns of the tail's joints from root to tip: upwards and to its left.
fn curled(pose: Pose, j: &Joints, up: [f64; 5], left: [f64; 5]) -> Pose {
    (0..5).fold(pose, |pose, i| pose.set(j.tail[i], turn(up[i], 0.0, -left[i])))
}

fn poses(skeleton: &Skeleton, j: &Joints) -> Vec<Pose> {
    let rest = || Pose::rest(skeleton);
    let legs = |pose: Pose, fore: [[f64; 3]; 2], hind: [[f64; 3]; 2]| {
        pose.both(j.shoulder, fore.map(|t| turn(t[0], -2.0, 0.0)))
            .both(j.elbow, fore.map(|t| flex(t[1])))
            .both(j.wrist, fore.map(|t| flex(t[2])))
            .both(j.hip, hind.map(|t| turn(t[0], -2.0, 0.0)))
            .both(j.knee, hind.map(|t| flex(t[1])))
            .both(j.hock, hind.map(|t| flex(t[2])))
    };
    vec![
        rest(),
        // Walking, tail up.
        curled(
            legs(
                rest(),
                [[-26.0, -8.0, 4.0], [22.0, -20.0, 40.0]],
                [[24.0, -6.0, 10.0], [-24.0, 16.0, -18.0]],
            ),
            j,
            [35.0, 25.0, 10.0, -15.0, -25.0],
            [0.0; 5],
        )
        .set(j.neck, flex(-8.0)),
        // Running.
        curled(
            legs(
                rest().root(flex(-4.0)),
                [[-38.0, -22.0, 6.0], [-22.0, -34.0, 34.0]],
                [[30.0, -18.0, 24.0], [18.0, -8.0, 16.0]],
            ),
            j,
            [8.0, 4.0, 0.0, 6.0, 10.0],
            [4.0; 5],
        )
        .set(j.neck, flex(16.0)),
        // Sitting.
        curled(
            legs(
                rest().root(flex(-40.0)),
                [[42.0, 4.0, 0.0], [46.0, 2.0, 0.0]],
                [[-10.0, 62.0, -84.0], [-10.0, 62.0, -84.0]],
            ),
            j,
            [26.0, 14.0, 4.0, 0.0, 0.0],
            [25.0, 30.0, 30.0, 30.0, 30.0],
        )
        .same(j.toes, flex(62.0))
        .set(j.loin, flex(-8.0))
        .set(j.neck, turn(40.0, 0.0, 16.0)),
        // Arched back.
        curled(
            legs(
                rest().root(flex(-26.0)),
                [[18.0, -4.0, 4.0], [14.0, -4.0, 4.0]],
                [[8.0, -6.0, 12.0], [12.0, -6.0, 10.0]],
            ),
            j,
            [55.0, 35.0, 10.0, -10.0, -15.0],
            [0.0; 5],
        )
        .set(j.loin, flex(32.0))
        .set(j.chest, flex(28.0))
        .set(j.neck, flex(-24.0)),
        // Play bow: front down, rump up.
        curled(
            legs(
                rest().root(flex(14.0)),
                [[-58.0, -14.0, 10.0], [-52.0, -14.0, 10.0]],
                [[-14.0, 2.0, 0.0], [-10.0, 0.0, 0.0]],
            ),
            j,
            [40.0, 28.0, 20.0, 16.0, 10.0],
            [10.0, 10.0, 20.0, 20.0, 10.0],
        )
        .set(j.chest, flex(-6.0))
        .set(j.neck, flex(-26.0)),
        // Lifting a paw, looking aside.
        curled(
            legs(rest(), [[-62.0, 38.0, 48.0], [4.0, -2.0, 0.0]], [[6.0, 0.0, 4.0], [-8.0, 8.0, -6.0]]),
            j,
            [-20.0, -10.0, 10.0, 28.0, 30.0],
            [10.0, 20.0, 20.0, 0.0, -20.0],
        )
        .set(j.neck, turn(-6.0, 0.0, 40.0)),
        // Creeping.
        curled(
            legs(
                rest(),
                [[38.0, -62.0, 34.0], [-22.0, -24.0, 26.0]],
                [[-38.0, 48.0, -30.0], [6.0, 34.0, -18.0]],
            ),
            j,
            [-22.0, -4.0, 8.0, 14.0, 14.0],
            [-14.0, -20.0, -24.0, 20.0, 30.0],
        )
        .set(j.neck, flex(10.0)),
        // Turning round.
        curled(
            legs(rest(), [[-16.0, -4.0, 4.0], [14.0, -14.0, 22.0]], [[12.0, -4.0, 6.0], [-12.0, 8.0, -8.0]]),
            j,
            [20.0, 10.0, 10.0, 10.0, 10.0],
            [-30.0, -30.0, -20.0, -10.0, 10.0],
        )
        .set(j.loin, turn(0.0, 0.0, 28.0))
        .set(j.chest, turn(0.0, 0.0, 26.0))
        .set(j.neck, turn(0.0, 0.0, 42.0)),
    ]
}
