//! A cat: standing, walking, stretching, sitting, hunting.
//!
//! Lengths are centimetres of a large cat, `z` is up, it faces `-y`, and its left is at `x > 0`. Angles are
//! in degrees. A negative `x` swings a leg forwards; a positive `x` turns the front of the trunk down, nods
//! the head and curls the tail upwards.

use crate::implicit::{Blob, Body, Part};
use crate::model::Model;
use crate::pose::{Pose, flex, turn};
use crate::skeleton::{Joint, JointId, JointPair, Node, Skeleton, joint_pairs, joints, node};

/// The model of the family.
pub(crate) fn model() -> Model {
    let (skeleton, joints) = skeleton();
    let poses = poses(&skeleton, &joints);
    Model { body: body(), skeleton, poses, genus: 0, area: 19_750.0, spacing: 1.4 }
}

fn body() -> Body {
    let mut parts = vec![trunk(), neck()];
    let head = std::iter::once(head()).chain(face()).chain([ear(), ear_hollow()]);
    parts.extend(head.map(|part| part.moved(HEAD_SCALE, HEAD_OFFSET)));
    parts.extend([foreleg(), hindleg(), tail()]);
    Body::new(parts)
}

/// The head is described in a larger size and scaled down.
const HEAD_SCALE: f64 = 0.8;
/// The scaling keeps the nape in its place.
const HEAD_OFFSET: [f64; 3] = [0.0, -48.0 * (1.0 - HEAD_SCALE), 75.0 * (1.0 - HEAD_SCALE)];

fn trunk() -> Part {
    let sideways = [1.0, 0.0, 0.0];
    Part::added(vec![
        Blob::cone([0.0, -24.0, 53.0], 19.6, [0.0, 4.0, 53.0], 20.0).flat(sideways, 0.84),
        Blob::cone([0.0, 4.0, 53.0], 20.0, [0.0, 26.0, 55.0], 17.6).flat(sideways, 0.84).blend(1.0),
        // Rump and chest.
        Blob::cone([0.0, 26.0, 56.0], 16.8, [0.0, 34.0, 58.0], 14.0).flat(sideways, 0.88).blend(2.0),
        Blob::ball([0.0, -33.0, 54.0], 16.0).flat(sideways, 0.9).blend(4.0),
    ])
}

fn neck() -> Part {
    Part::added(vec![Blob::cone([0.0, -31.0, 62.0], 12.0, [0.0, -48.0, 75.0], 10.2)]).blend(6.0)
}

fn head() -> Part {
    Part::added(vec![
        Blob::ball([0.0, -54.0, 80.0], 13.4).flat([0.0, 0.0, 1.0], 0.92),
        // Cheeks, muzzle, chin.
        Blob::ball([6.4, -56.0, 76.0], 7.8).blend(4.0),
        Blob::cone([0.0, -61.0, 75.5], 7.4, [0.0, -66.6, 74.0], 5.4).blend(4.0),
        Blob::ball([2.9, -67.8, 73.2], 4.0).blend(1.6),
        Blob::ball([0.0, -66.2, 69.9], 3.4).blend(1.6),
    ])
    .blend(4.0)
}

fn face() -> Vec<Part> {
    vec![
        Part::carved(vec![Blob::ball([5.8, -68.4, 82.0], 3.9)]).blend(2.0),
        Part::added(vec![Blob::ball([5.5, -63.6, 81.8], 2.9)]).blend(1.0),
        // Bridge and tip of the nose.
        Part::added(vec![
            Blob::cone([0.0, -64.0, 81.0], 2.4, [0.0, -70.2, 76.4], 1.8),
            Blob::ball([0.0, -71.0, 76.0], 1.8).blend(0.8),
        ])
        .blend(2.0),
    ]
}

fn ear() -> Part {
    Part::added(vec![
        Blob::cone([7.4, -51.5, 88.0], 7.4, [11.4, -49.8, 101.5], 2.6).flat([0.28, 1.0, -0.1], 0.52),
    ])
    .blend(3.0)
}

fn ear_hollow() -> Part {
    Part::carved(vec![
        Blob::cone([8.6, -57.0, 92.0], 3.9, [10.6, -55.4, 98.5], 1.6).flat([0.28, 1.0, -0.1], 0.6),
    ])
    .blend(1.2)
}

fn foreleg() -> Part {
    Part::added(vec![
        // Shoulder blade and upper arm, close to the chest.
        Blob::cone([8.6, -22.0, 64.0], 7.0, [9.4, -32.0, 52.0], 8.2),
        Blob::cone([9.4, -32.0, 52.0], 8.0, [10.2, -25.0, 37.0], 5.5).blend(1.0),
        Blob::cone([10.2, -25.0, 37.0], 5.5, [10.4, -28.5, 13.0], 4.0),
        Blob::cone([10.4, -28.5, 13.0], 4.0, [10.4, -29.5, 5.5], 4.3),
        Blob::cone([10.4, -30.5, 4.0], 5.0, [10.4, -34.0, 3.8], 4.9).flat([0.0, 0.0, 1.0], 0.76).blend(1.5),
    ])
    .blend(5.0)
}

fn hindleg() -> Part {
    Part::added(vec![
        Blob::cone([8.6, 29.0, 58.0], 12.4, [11.0, 23.0, 42.0], 8.0),
        Blob::cone([11.0, 24.0, 42.0], 7.4, [11.4, 38.0, 21.5], 4.0).blend(4.0),
        Blob::cone([11.4, 38.0, 21.5], 4.0, [11.4, 34.0, 6.5], 3.8),
        Blob::cone([11.4, 32.0, 4.2], 4.6, [11.4, 27.0, 3.8], 5.0).flat([0.0, 0.0, 1.0], 0.76).blend(1.5),
    ])
    .blend(6.0)
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
    Part::added(Blob::tube(([0.0, 34.0, 64.0], 7.0), TAIL, [4.4, 3.6, 3.3, 3.1, 2.9, 2.5])).blend(4.0)
}

struct Joints {
    /// For loin and chest, `x` turns the front down and `z` turns it to the left.
    loin: JointId,
    chest: JointId,
    neck: JointId,
    /// From root to tip.
    tail: [JointId; 5],
    /// Shoulder, elbow, wrist.
    forelegs: [JointPair; 3],
    /// Hip, knee, hock.
    hindlegs: [JointPair; 3],
    toes: JointPair,
}

/// A node of the head, described in the same size as its parts.
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
    let (stiff, loose) = ([12.0, 0.0, 12.0], [20.0, 0.0, 20.0]);
    let tail = skeleton.tail(
        (spine, 0),
        node([0.0, 33.0, 63.0], 8.0, 0.8),
        TAIL,
        3.6,
        [0.62, 0.55, 0.52, 0.5, 0.48, 0.42],
        &[stiff, loose, loose, loose, loose],
    );
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
            Joint::leg(2, 8.0, 8.0, 8.0),
            Joint::leg(3, 6.0, 6.0, 10.0),
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
            Joint::leg(2, 8.0, 8.0, 8.0),
            Joint::leg(3, 9.0, 8.0, 8.0),
            Joint::leg(4, 4.0, 6.0, 8.0),
        ],
    );
    // The ears do not move; their chains only cause small triangles.
    skeleton.pair(
        (spine, 6),
        vec![in_head([6.5, -52.0, 90.0], 5.0, 0.5), in_head([11.4, -49.8, 101.5], 3.6, 0.3)],
        Vec::new(),
    );
    let ([loin, chest, neck], [hip, knee, hock, toes]) = (joints(spine), joint_pairs(hindlegs));
    let (tail, forelegs, hindlegs) = (joints(tail), joint_pairs(forelegs), [hip, knee, hock]);
    (skeleton, Joints { loin, chest, neck, tail, forelegs, hindlegs, toes })
}

fn poses(skeleton: &Skeleton, j: &Joints) -> Vec<Pose> {
    let rest = || Pose::rest(skeleton);
    let legs = |pose: Pose, fore, hind| pose.legs(j.forelegs, -2.0, fore).legs(j.hindlegs, -2.0, hind);
    vec![
        rest(),
        // Trotting, tail up.
        legs(rest(), [[-40.0, -12.0, 6.0], [30.0, -34.0, 56.0]], [[34.0, -8.0, 14.0], [-36.0, 28.0, -26.0]])
            .tail(j.tail, [45.0, 30.0, 10.0, -20.0, -35.0], [0.0; 5])
            .set(j.neck, turn(-10.0, 0.0, -20.0)),
        // Leaping, stretched out.
        legs(
            rest().root(flex(-18.0)),
            [[-36.0, -18.0, 10.0], [-26.0, -34.0, 28.0]],
            [[22.0, -18.0, 26.0], [16.0, -10.0, 20.0]],
        )
        .tail(j.tail, [-6.0, -4.0, 6.0, 14.0, 20.0], [8.0; 5])
        .set(j.neck, flex(14.0)),
        // Sitting, licking a paw.
        legs(
            rest().root(flex(-44.0)),
            [[38.0, 2.0, 0.0], [-12.0, -60.0, 44.0]],
            [[-8.0, 58.0, -84.0], [-12.0, 58.0, -84.0]],
        )
        .tail(j.tail, [34.0, 22.0, 4.0, 0.0, 0.0], [30.0, 34.0, 34.0, 34.0, 34.0])
        .same(j.toes, flex(62.0))
        .set(j.loin, flex(6.0))
        .set(j.chest, flex(6.0))
        .set(j.neck, turn(46.0, 0.0, -14.0)),
        // Arched back.
        legs(
            rest().root(flex(-20.0)),
            [[14.0, -4.0, 4.0], [8.0, -4.0, 4.0]],
            [[8.0, -8.0, 14.0], [12.0, -8.0, 12.0]],
        )
        .tail(j.tail, [44.0, 40.0, 14.0, -15.0, -20.0], [0.0; 5])
        .set(j.loin, flex(22.0))
        .set(j.chest, flex(20.0))
        .set(j.neck, flex(-12.0)),
        // Play bow: front down, rump up.
        legs(
            rest().root(flex(18.0)),
            [[-46.0, -22.0, 16.0], [-38.0, -26.0, 20.0]],
            [[-18.0, 4.0, 0.0], [-12.0, 0.0, 0.0]],
        )
        .tail(j.tail, [46.0, 34.0, 24.0, 20.0, 14.0], [14.0, 14.0, 24.0, 24.0, 14.0])
        .set(j.chest, flex(-6.0))
        .set(j.neck, flex(-24.0)),
        // Upright on its hind legs, batting at something.
        legs(
            rest().root(flex(-48.0)),
            [[-20.0, -48.0, 24.0], [0.0, -64.0, 40.0]],
            [[16.0, 26.0, -2.0], [10.0, 32.0, -10.0]],
        )
        .tail(j.tail, [-16.0, 14.0, 34.0, 34.0, 24.0], [10.0, 14.0, 14.0, 10.0, 0.0])
        .set(j.loin, flex(8.0))
        .set(j.neck, turn(32.0, 0.0, 12.0)),
        // Crouching, ready to spring.
        legs(
            rest(),
            [[54.0, -92.0, 40.0], [46.0, -84.0, 38.0]],
            [[-46.0, 74.0, -58.0], [-40.0, 68.0, -54.0]],
        )
        .tail(j.tail, [-26.0, -8.0, 8.0, 16.0, 16.0], [-20.0, -26.0, -30.0, -20.0, 30.0])
        .same(j.toes, flex(26.0))
        .set(j.neck, turn(4.0, 0.0, 18.0)),
        // Chasing its tail.
        legs(rest(), [[-26.0, -8.0, 8.0], [20.0, -22.0, 34.0]], [[18.0, -6.0, 10.0], [-20.0, 14.0, -14.0]])
            .tail(j.tail, [14.0, 6.0, 6.0, 6.0, 6.0], [40.0, 36.0, 30.0, 24.0, 16.0])
            .set(j.loin, turn(4.0, 0.0, 20.0))
            .set(j.chest, turn(4.0, 0.0, 20.0))
            .set(j.neck, turn(0.0, 0.0, 40.0)),
    ]
}
