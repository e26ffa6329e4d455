//! Where alignments start.

use std::f64::consts::TAU;

use nalgebra::{Matrix3, Quaternion, Rotation3, Unit, UnitQuaternion, Vector3};

use crate::rigid_surface::RigidSurface;
use crate::similarity::Similarity;

/// Axes whose deviations differ by less than this factor in both bodies may be exchanged or turned into each other, since their
/// order is arbitrary. A safety limit: more starts cost time only.
const NEAR_EQUAL_AXES: f64 = 1.15;

/// Directions of planes and axes that are tried for frames and mirror planes, those with the largest area. A limit of effort.
const MAX_DIRECTIONS: usize = 6;

/// Directions that span a frame are at least this far from parallel (sine). A safety limit.
const ACROSS: f64 = 0.2;

/// Shares of the area, and half of the cosines, that differ by less than this are alike, so that more frames are tried. A
/// safety limit.
const ALIKE: f64 = 0.025;

/// Turned starts about one axis, and about all. Limits of effort.
const TURNS: usize = 36;
const ORIENTATIONS: usize = 300;

/// Whether the first and second, and the second and third axis are nearly equal in both.
pub(crate) fn equal_axes(a: [f64; 3], b: [f64; 3]) -> [bool; 2] {
    [0, 1].map(|i| [a, b].iter().all(|std| std[i] <= NEAR_EQUAL_AXES * std[i + 1]))
}

/// The 8 to 48 motions of the principal axes of a body onto those of another, with these deviations: all signs, and exchanges of
/// axes with near-equal deviations in both.
pub(crate) fn axis_motions(a: [f64; 3], b: [f64; 3]) -> Vec<Similarity> {
    // Axes 0 and 2 are exchanged only if both are close to axis 1.
    let permutations: &[[usize; 3]] = match equal_axes(a, b) {
        [false, false] => &[[0, 1, 2]],
        [true, false] => &[[0, 1, 2], [1, 0, 2]],
        [false, true] => &[[0, 1, 2], [0, 2, 1]],
        [true, true] => &[[0, 1, 2], [1, 0, 2], [0, 2, 1], [2, 1, 0], [1, 2, 0], [2, 0, 1]],
    };
    let signed = |permutation: &[usize; 3], signs: usize| {
        let mut matrix = Matrix3::zeros();
        for (i, j) in permutation.iter().enumerate() {
            matrix[(i, *j)] = if signs >> i & 1 == 0 { 1.0 } else { -1.0 };
        }
        Similarity::about_origin(matrix)
    };
    permutations.iter().flat_map(|order| (0..8).map(move |signs| signed(order, signs))).collect()
}

/// Starts that are turned about axes which the deviations of a surface do not determine; `axes` are the principal axes of the
/// second surface.
pub(crate) fn turned_starts(
    equal: [bool; 2],
    axes: &[Vector3<f64>; 3],
    start: &Similarity,
) -> Vec<Similarity> {
    let turned = |turn: Rotation3<f64>| Similarity::about_origin(turn.into_inner()).after(start);
    let about = |axis: &Vector3<f64>| {
        let axis = Unit::new_normalize(*axis);
        let turn = |i: usize| Rotation3::from_axis_angle(&axis, TAU * i as f64 / TURNS as f64);
        (1..TURNS).map(|i| turned(turn(i))).collect()
    };
    match equal {
        [true, true] => (0..ORIENTATIONS).map(|i| turned(orientation(i))).collect(),
        [true, false] => about(&axes[2]),
        [false, true] => about(&axes[0]),
        [false, false] => Vec::new(),
    }
}

/// One of many evenly spread orientations (Shoemake's uniform quaternions from an additive sequence).
fn orientation(i: usize) -> Rotation3<f64> {
    const STEPS: [f64; 3] = [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_970_3];
    let [u, v, w] = STEPS.map(|step| (0.5 + step * i as f64).fract());
    let (v, w) = (TAU * v, TAU * w);
    let (a, b) = ((1.0 - u).sqrt(), u.sqrt());
    let quaternion = Quaternion::new(a * v.sin(), a * v.cos(), b * w.sin(), b * w.cos());
    UnitQuaternion::from_quaternion(quaternion).to_rotation_matrix()
}

/// Motions that take the two main directions of planes and axes of one part to two of the other.
pub(crate) fn framed_starts(a: &RigidSurface, b: &RigidSurface, reflected: bool) -> Vec<Similarity> {
    let [of_a, of_b] = [a, b].map(|part| part.regions().directions());
    let is_across = |x: &Vector3<f64>, y: &Vector3<f64>| x.cross(y).norm() > ACROSS;
    let Some(&(first, area)) = of_a.first() else { return Vec::new() };
    let Some(&(second, other_area)) = of_a.iter().find(|(d, _)| is_across(d, &first)) else {
        return Vec::new();
    };
    let alike = |x: f64, y: f64| (x - y).abs() < ALIKE;
    let main = || of_b.iter().take(MAX_DIRECTIONS);
    let pairs = main().flat_map(|x| main().map(move |y| (*x, *y)));
    let fitting = pairs.filter(|((x, area_x), (y, area_y))| {
        is_across(x, y)
            && alike(*area_x, area)
            && alike(*area_y, other_area)
            && alike(0.5 * x.dot(y).abs(), 0.5 * first.dot(&second).abs())
    });
    fitting
        .flat_map(|((x, _), (y, _))| [[x, y], [x, -y], [-x, y], [-x, -y]])
        .filter_map(|to| Similarity::between_frames([first, second], to, reflected))
        .collect()
}

/// Reflections in planes through the centroid that may leave a surface as it is: across its principal axes, and across its
/// planes and axes and halfway between them.
pub(crate) fn mirrors(surface: &RigidSurface) -> impl Iterator<Item = Similarity> {
    let directions = surface.regions().directions();
    let main: Vec<Vector3<f64>> = directions.iter().take(MAX_DIRECTIONS).map(|(d, _)| *d).collect();
    let mut normals: Vec<Vector3<f64>> = surface.principal_axes().into_iter().flatten().collect();
    normals.extend(&main);
    for (i, d) in main.iter().enumerate() {
        let between = main[..i].iter().flat_map(|e| [d + e, d - e, d.cross(e)]);
        normals.extend(between.filter_map(|normal| normal.try_normalize(1e-3)));
    }
    normals.into_iter().map(|n| Similarity::about_origin(Matrix3::identity() - 2.0 * n * n.transpose()))
}
