//! A cat: standing, walking, stretching, sitting, hunting.
//!
//! Centimetres of a large cat; `z` up, facing `-y`, its left at `x > 0`. Angles in degrees. For legs a
//! negative `x` swings forwards; for the trunk a positive `x` turns the front end down, for the neck it
//! nods, for the tail a positive `x` curls upwards.

use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, Turn, turn};
use crate::skeleton::{Joint, JointId, JointPair, Node, Skeleton, node};

/// The family's model.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, area: 19_750.0, spacing: 1.4 }
}

fn body() -> Body {
    let mut parts = vec![trunk(), neck()];
    let head = std::iter::once(head()).chain(face()).chain([ear(), ear_hollow()]);
    parts.extend(head.map(|part| part.moved(HEAD_SCALE, HEAD_OFFSET)));
    parts.extend([foreleg(), hindleg(), tail()]);
    Body::new(parts)
}

/// The head is described in a larger size than it has.
const HEAD_SCALE: f64 = 0.8;
/// Its scaling leaves the nape where it is.
const HEAD_OFFSET: [f64; 3] = [0.0, -48.0 * (1.0 - HEAD_SCALE), 75.0 * (1.0 - HEAD_SCALE)];

fn trunk() -> Part {
    let sideways = [1.0, 0.0, 0.0];
    Part::added(
        0.0,
        vec![
            Blob::cone([0.0, -24.0, 53.0], 19.6, [0.0, 4.0, 53.0], 20.0).flat(sideways, 0.84),
            Blob::cone([0.0, 4.0, 53.0], 20.0, [0.0, 26.0, 55.0], 17.6).flat(sideways, 0.84).blend(1.0),
            // Rump and chest.
            Blob::cone([0.0, 26.0, 56.0], 16.8, [0.0, 34.0, 58.0], 14.0).flat(sideways, 0.88).blend(2.0),
            Blob::ball([0.0, -33.0, 54.0], 16.0).flat(sideways, 0.9).blend(4.0),
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
            Blob::cone([8.6, -22.0, 64.0], 7.0, [9.4, -32.0, 52.0], 8.2),
            Blob::cone([9.4, -32.0, 52.0], 8.0, [10.2, -25.0, 37.0], 5.5).blend(1.0),
            Blob::cone([10.2, -25.0, 37.0], 5.5, [10.4, -28.5, 13.0], 4.0),
            Blob::cone([10.4, -28.5, 13.0], 4.0, [10.4, -29.5, 5.5], 4.3),
            Blob::cone([10.4, -30.5, 4.0], 5.0, [10.4, -34.0, 3.8], 4.9)
                .flat([0.0, 0.0, 1.0], 0.76)
                .blend(1.5),
        ],
    )
}

fn hindleg() -> Part {
    Part::added(
        6.0,
        vec![
            Blob::cone([8.6, 29.0, 58.0], 12.4, [11.0, 23.0, 42.0], 8.0),
            Blob::cone([11.0, 24.0, 42.0], 7.4, [11.4, 38.0, 21.5], 4.0).blend(4.0),
            Blob::cone([11.4, 38.0, 21.5], 4.0, [11.4, 34.0, 6.5], 3.8),
            Blob::cone([11.4, 32.0, 4.2], 4.6, [11.4, 27.0, 3.8], 5.0).flat([0.0, 0.0, 1.0], 0.76).blend(1.5),
        ],
    )
}

/// The axis of the tail at rest.
const TAIL: [[f64; 3]; 6] = [
    [0.0, 42.0, 65.0],
    [0.0, 58.0, 65.5],
    [0.0, 74.0, 64.0],
    [0.0, 90.0, 62.5],
    [0.0, 105.0, 62.0],
    [0.0, 120.0, 63.0],
];

fn tail() -> Part {
    let radii = [4.4, 3.6, 3.3, 3.1, 2.9, 2.5];
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

/// A node described like the parts of the head.
fn in_head(at: [f64; 3], radius: f64, grain: f64) -> Node {
    node(at, radius, grain).moved(HEAD_SCALE, HEAD_OFFSET)
}

fn skeleton() -> (Skeleton, Joints) {
    let mut skeleton = Skeleton::default();
    let spine = skeleton.chain(
        None,
        vec![
            node([0.0, 32.0, 58.0], 13.5, 1.0),
            node([0.0, 16.0, 56.0], 15.5, 1.1),
            node([0.0, -8.0, 55.0], 16.5, 1.1),
            node([0.0, -28.0, 56.0], 14.5, 1.0),
            node([0.0, -36.0, 64.0], 12.0, 0.85),
            node([0.0, -46.0, 73.0], 10.5, 0.75),
            in_head([0.0, -54.0, 82.0], 13.0, 0.58),
            in_head([0.0, -70.0, 76.0], 6.5, 0.34),
        ],
        vec![
            Joint::ball(1, 15.0, 16.0, [5.0, 4.0, 10.0]),
            Joint::ball(2, 8.0, 16.0, [4.0, 4.0, 8.0]),
            Joint::ball(4, 7.0, 16.0, [10.0, 8.0, 22.0]),
        ],
    );
    let tail_nodes: Vec<_> = std::iter::once(node([0.0, 33.0, 63.0], 8.0, 0.8))
        .chain(TAIL.iter().zip([0.62, 0.55, 0.52, 0.5, 0.48, 0.42]).map(|(&p, grain)| node(p, 3.6, grain)))
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
            node([7.0, -26.0, 62.0], 8.5, 1.0),
            node([9.4, -29.0, 50.0], 8.0, 0.9),
            node([10.2, -26.0, 37.0], 5.6, 0.75),
            node([10.4, -28.0, 13.0], 4.1, 0.58),
            node([10.4, -30.0, 5.0], 4.6, 0.5),
            node([10.4, -36.0, 3.6], 4.4, 0.42),
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
            node([6.0, 31.0, 60.0], 11.0, 1.0),
            node([8.8, 29.0, 54.0], 11.5, 0.95),
            node([11.2, 23.5, 40.0], 8.0, 0.8),
            node([11.4, 37.5, 21.5], 4.2, 0.6),
            node([11.4, 34.0, 6.5], 4.0, 0.5),
            node([11.4, 25.0, 3.8], 4.4, 0.42),
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
        vec![in_head([6.5, -52.0, 90.0], 5.0, 0.5), in_head([11.4, -49.8, 101.5], 3.6, 0.3)],
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
        // Trotting, tail up.
        curled(
            legs(
                rest(),
                [[-40.0, -12.0, 6.0], [30.0, -34.0, 56.0]],
                [[34.0, -8.0, 14.0], [-36.0, 28.0, -26.0]],
            ),
            j,
            [45.0, 30.0, 10.0, -20.0, -35.0],
            [0.0; 5],
        )
        .set(j.neck, turn(-10.0, 0.0, -20.0)),
        // Leaping, stretched out.
        curled(
            legs(
                rest().root(flex(-18.0)),
                [[-36.0, -18.0, 10.0], [-26.0, -34.0, 28.0]],
                [[22.0, -18.0, 26.0], [16.0, -10.0, 20.0]],
            ),
            j,
            [-6.0, -4.0, 6.0, 14.0, 20.0],
            [8.0; 5],
        )
        .set(j.neck, flex(14.0)),
        // Sitting, licking a paw.
        curled(
            legs(
                rest().root(flex(-44.0)),
                [[38.0, 2.0, 0.0], [-12.0, -60.0, 44.0]],
                [[-8.0, 58.0, -84.0], [-12.0, 58.0, -84.0]],
            ),
            j,
            [34.0, 22.0, 4.0, 0.0, 0.0],
            [30.0, 34.0, 34.0, 34.0, 34.0],
        )
        .same(j.toes, flex(62.0))
        .set(j.loin, flex(6.0))
        .set(j.chest, flex(6.0))
        .set(j.neck, turn(46.0, 0.0, -14.0)),
        // Arched back.
        curled(
            legs(
                rest().root(flex(-20.0)),
                [[14.0, -4.0, 4.0], [8.0, -4.0, 4.0]],
                [[8.0, -8.0, 14.0], [12.0, -8.0, 12.0]],
            ),
            j,
            [44.0, 40.0, 14.0, -15.0, -20.0],
            [0.0; 5],
        )
        .set(j.loin, flex(22.0))
        .set(j.chest, flex(20.0))
        .set(j.neck, flex(-12.0)),
        // Play bow: front down, rump up.
        curled(
            legs(
                rest().root(flex(18.0)),
                [[-46.0, -22.0, 16.0], [-38.0, -26.0, 20.0]],
                [[-18.0, 4.0, 0.0], [-12.0, 0.0, 0.0]],
            ),
            j,
            [46.0, 34.0, 24.0, 20.0, 14.0],
            [14.0, 14.0, 24.0, 24.0, 14.0],
        )
        .set(j.chest, flex(-6.0))
        .set(j.neck, flex(-24.0)),
        // Upright on its hind legs, batting at something.
        curled(
            legs(
                rest().root(flex(-48.0)),
                [[-20.0, -48.0, 24.0], [0.0, -64.0, 40.0]],
                [[16.0, 26.0, -2.0], [10.0, 32.0, -10.0]],
            ),
            j,
            [-16.0, 14.0, 34.0, 34.0, 24.0],
            [10.0, 14.0, 14.0, 10.0, 0.0],
        )
        .set(j.loin, flex(8.0))
        .set(j.neck, turn(32.0, 0.0, 12.0)),
        // Crouching, ready to spring.
        curled(
            legs(
                rest(),
                [[54.0, -92.0, 40.0], [46.0, -84.0, 38.0]],
                [[-46.0, 74.0, -58.0], [-40.0, 68.0, -54.0]],
            ),
            j,
            [-26.0, -8.0, 8.0, 16.0, 16.0],
            [-20.0, -26.0, -30.0, -20.0, 30.0],
        )
        .same(j.toes, flex(26.0))
        .set(j.neck, turn(4.0, 0.0, 18.0)),
        // Chasing its tail.
        curled(
            legs(
                rest(),
                [[-26.0, -8.0, 8.0], [20.0, -22.0, 34.0]],
                [[18.0, -6.0, 10.0], [-20.0, 14.0, -14.0]],
            ),
            j,
            [14.0, 6.0, 6.0, 6.0, 6.0],
            [40.0, 36.0, 30.0, 24.0, 16.0],
        )
        .set(j.loin, turn(4.0, 0.0, 20.0))
        .set(j.chest, turn(4.0, 0.0, 20.0))
        .set(j.neck, turn(0.0, 0.0, 40.0)),
    ]
}
