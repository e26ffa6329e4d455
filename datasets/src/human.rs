//! The upper half of a man, which david and the centaur share.
//!
//! Lengths are in centimetres, `z` is up, he faces `-y`, his left is at `x > 0`, and the navel is at height
//! 106. The arms are 30 degrees below the horizontal with the palms down.

use crate::implicit::{Blob, Part};
use crate::skeleton::{Joint, Node, node};

/// The shoulder joint, and the directions along the arm and to the back of the hand.
const SHOULDER: [f64; 3] = [19.0, 0.5, 139.5];
const ALONG: [f64; 3] = [0.866_025, 0.0, -0.5];
const DORSAL: [f64; 3] = [0.5, 0.0, 0.866_025];
/// Distances of the joints from the shoulder.
const ELBOW: f64 = 29.0;
const WRIST: f64 = 54.5;
const KNUCKLES: f64 = 63.5;
const FINGERTIPS: f64 = 72.5;

/// A point of the left arm, given by its distances from the shoulder, to the front and to the back of the hand.
fn arm(along: f64, front: f64, dorsal: f64) -> [f64; 3] {
    [0, 1, 2].map(|i| SHOULDER[i] + along * ALONG[i] + dorsal * DORSAL[i] - if i == 1 { front } else { 0.0 })
}

/// Trunk above the navel, neck, head and arms.
pub(crate) fn parts() -> Vec<Part> {
    let mut parts = vec![trunk(), shoulders(), head()];
    parts.extend(face());
    parts.push(arm_part());
    parts.push(hand());
    parts
}

fn trunk() -> Part {
    Part::added(vec![
        Blob::cone([4.2, -0.2, 104.0], 8.9, [4.4, 0.0, 111.0], 8.8),
        Blob::cone([4.4, 0.0, 112.0], 8.8, [7.6, 0.6, 130.0], 9.7).blend(2.0),
        Blob::cone([0.0, 0.4, 120.0], 9.2, [0.0, 0.6, 134.0], 9.4).blend(3.0),
        Blob::ball([6.5, 1.2, 135.5], 8.4).blend(3.0),
        // Chest muscles, and the broad muscles of the back.
        Blob::cone([5.6, -6.6, 131.5], 6.4, [9.4, -5.8, 132.0], 6.4).flat([0.25, 1.0, 0.05], 0.5).blend(1.8),
        Blob::cone([9.5, 5.0, 131.0], 6.0, [6.0, 4.6, 119.0], 4.6).blend(3.0),
    ])
    .blend(5.0)
}

fn shoulders() -> Part {
    Part::added(vec![
        Blob::cone([0.0, 2.2, 140.0], 6.6, [0.0, 1.0, 153.0], 5.6),
        Blob::cone([2.5, 2.8, 147.0], 4.4, [13.5, 1.8, 142.0], 4.8).blend(4.0),
        Blob::cone([11.0, 1.5, 138.5], 6.2, [18.5, 0.8, 139.0], 5.8).blend(3.0),
    ])
    .blend(5.0)
}

fn head() -> Part {
    Part::added(vec![
        Blob::ball([0.0, 1.4, 165.2], 9.8).flat([1.0, 0.0, 0.0], 0.80),
        Blob::cone([0.0, -2.2, 162.5], 7.2, [0.0, -4.0, 157.5], 5.0).flat([1.0, 0.0, 0.0], 0.88).blend(3.0),
        // Jaw: from the ear to the chin.
        Blob::cone([4.4, -0.4, 157.6], 1.7, [0.8, -6.6, 153.2], 1.9).blend(3.0),
        Blob::ball([0.0, -7.5, 153.6], 1.9).blend(1.5),
    ])
    .blend(3.0)
}

fn face() -> Vec<Part> {
    vec![
        // Eye sockets, eyes.
        Part::carved(vec![Blob::cone([2.6, -11.0, 162.4], 2.0, [4.6, -9.6, 162.2], 1.6)]).blend(1.8),
        Part::added(vec![Blob::ball([3.2, -7.6, 162.2], 1.5)]).blend(0.9),
        // Brow, nose, lips.
        Part::added(vec![Blob::cone([0.8, -8.9, 164.3], 1.0, [4.4, -7.4, 164.5], 0.9)]).blend(1.2),
        Part::added(vec![
            Blob::cone([0.0, -8.9, 163.2], 0.9, [0.0, -11.4, 159.2], 1.3),
            Blob::ball([1.1, -10.1, 158.7], 0.95).blend(0.8),
        ])
        .blend(1.4),
        Part::added(vec![
            Blob::cone([0.0, -8.7, 156.6], 0.9, [1.9, -7.8, 156.4], 0.5),
            Blob::cone([0.0, -8.6, 155.5], 0.9, [1.7, -7.7, 155.7], 0.5).blend(0.3),
        ])
        .blend(0.8),
        // Ears.
        Part::added(vec![
            Blob::cone([7.4, 1.2, 159.4], 1.4, [8.1, 2.4, 163.0], 2.3).flat([1.0, -0.45, 0.0], 0.42),
        ])
        .blend(0.8),
    ]
}

fn arm_part() -> Part {
    Part::added(vec![
        Blob::cone(arm(0.0, 0.0, 0.4), 6.4, arm(10.0, 0.0, 0.0), 4.8),
        Blob::cone(arm(8.0, 0.0, 0.0), 4.7, arm(ELBOW, 0.0, 0.0), 3.7).blend(1.0),
        // Biceps (in front, since the palms are down) and triceps.
        Blob::cone(arm(11.0, 1.4, 0.0), 4.4, arm(19.0, 1.4, 0.0), 4.0).blend(1.5),
        Blob::cone(arm(9.0, -1.6, 0.0), 4.4, arm(18.0, -1.4, 0.0), 3.8).blend(1.5),
        Blob::cone(arm(ELBOW, 0.0, 0.0), 3.7, arm(ELBOW + 7.0, 0.4, 0.0), 4.2).blend(0.6),
        Blob::cone(arm(ELBOW + 7.0, 0.4, 0.0), 4.2, arm(WRIST, 0.0, 0.0), 2.7).blend(0.6),
    ])
    .blend(4.0)
}

fn hand() -> Part {
    let mut blobs = vec![
        Blob::cone(arm(WRIST, 0.0, 0.0), 2.9, arm(WRIST + 4.5, 0.0, 0.0), 4.0).flat(DORSAL, 0.62),
        Blob::cone(arm(WRIST + 4.0, 0.2, 0.0), 3.9, arm(KNUCKLES - 1.5, 0.0, 0.0), 4.3)
            .flat(DORSAL, 0.42)
            .blend(1.5),
        // Thumb.
        Blob::cone(arm(WRIST + 2.5, 2.2, -0.3), 1.7, arm(WRIST + 6.5, 5.0, -0.5), 1.35).blend(1.5),
        Blob::cone(arm(WRIST + 6.5, 5.0, -0.5), 1.3, arm(WRIST + 10.0, 6.5, -0.5), 1.0).blend(0.3),
    ];
    // Index to little finger: position at the knuckles, position at the tip, length.
    for (front, spread, length) in [(3.0, 5.7, 8.2), (1.0, 1.9, 9.3), (-1.0, -2.0, 8.8), (-2.8, -5.6, 7.0)] {
        blobs.push(
            Blob::cone(arm(KNUCKLES - 2.5, front, 0.0), 1.2, arm(KNUCKLES + length, spread, -0.4), 0.85)
                .blend(0.5),
        );
    }
    Part::added(blobs).blend(1.5)
}

/// Spine of the trunk and head; the lower body is attached to the first node.
pub(crate) fn spine_nodes() -> Vec<Node> {
    vec![
        node([0.0, -2.5, 106.0], 12.5, 1.15),
        node([0.0, -2.5, 120.0], 13.0, 1.15),
        node([0.0, -1.5, 134.0], 13.0, 1.05),
        node([0.0, 1.0, 144.0], 8.0, 0.8),
        node([0.0, 0.0, 154.5], 6.5, 0.62),
        node([0.0, 2.0, 166.0], 9.0, 0.66),
        node([0.0, -9.0, 159.5], 5.5, 0.28),
    ]
}

/// Joints of the trunk and neck, given the number of nodes before [`spine_nodes`].
pub(crate) fn spine_joints(first: usize) -> Vec<Joint> {
    vec![
        Joint::ball(first, 9.0, 11.0, [6.0, 4.0, 5.0]),
        Joint::ball(first + 2, 14.0, 8.0, [4.0, 3.0, 6.0]),
        Joint::ball(first + 3, 1.0, 11.0, [8.0, 6.0, 16.0]),
    ]
}

/// From the breastbone to the fingertips; the first two nodes move with the chest.
pub(crate) fn arm_nodes() -> Vec<Node> {
    vec![
        node([4.0, 0.5, 139.0], 8.0, 0.9),
        node([SHOULDER[0] - 2.0, SHOULDER[1], SHOULDER[2]], 6.5, 0.85),
        node(arm(ELBOW, 0.8, 0.0), 4.0, 0.68),
        node(arm(WRIST, 0.0, -0.4), 2.8, 0.48),
        node(arm(KNUCKLES, 0.0, -0.4), 3.2, 0.34),
        node(arm(FINGERTIPS, 0.0, -0.4), 3.0, 0.30),
    ]
}

/// Shoulder (about the axes of the body), elbow (a positive `x` flexes, `y` twists the forearm), wrist and
/// knuckles (a positive `x` flexes).
pub(crate) fn arm_joints() -> Vec<Joint> {
    let towards_palm = [0.0, 1.0, 0.0];
    let forwards = DORSAL.map(|x| -x);
    let mut elbow = Joint::hinge(2, 8.0, 8.0, forwards, ALONG, 10.0);
    elbow.play[1] = 15.0;
    vec![
        Joint::ball(1, 4.0, 13.0, [8.0, 8.0, 8.0]),
        elbow,
        Joint::hinge(3, 3.0, 4.5, towards_palm, ALONG, 12.0),
        Joint::hinge(4, 1.0, 6.0, towards_palm, ALONG, 14.0),
    ]
}
