//! Points in the plane, and triangles laid out there.

use surface::Triangle;

pub(crate) type PlanePoint = [f64; 2];

/// The next and the previous of the three corners of a triangle.
#[inline]
pub(crate) fn around(slot: usize) -> [usize; 2] {
    // A table, because a branch would be mispredicted every third time.
    [[1, 2], [2, 0], [0, 1]][slot]
}

pub(crate) fn sub(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

#[inline(always)]
pub(crate) fn dot(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

#[inline(always)]
pub(crate) fn norm(a: PlanePoint) -> f64 {
    dot(a, a).sqrt()
}

/// Twice the area of the triangle between the origin, `a` and `b`; positive if `b` lies to the left of `a`.
#[inline(always)]
pub(crate) fn cross(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn between(a: PlanePoint, b: PlanePoint, t: f64) -> PlanePoint {
    [a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]
}

pub(crate) fn distance(a: PlanePoint, b: PlanePoint) -> f64 {
    let [x, y] = sub(a, b);
    x.hypot(y)
}

/// The apex of a triangle with the lengths of the base, on the x-axis from the origin, and of the sides from its
/// start and end.
pub(crate) fn apex(sides: [f64; 3]) -> PlanePoint {
    let Triangle { x, y, .. } = Triangle::from_sides(sides);
    // It may be anywhere on the line if the lengths violate the triangle inequality.
    [x.clamp(-sides[1], sides[1]), y]
}

/// A side of a gate that is crossed with its left end on the left.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum GateSide {
    Behind,
    Ahead,
}

/// The third corner of a face on one side of a gate, from the lengths of the gate and of the sides from its left and
/// its right end.
pub(crate) fn beyond([left, right]: [PlanePoint; 2], lengths: [f64; 3], side: GateSide) -> PlanePoint {
    let base = lengths[0];
    let [x, y] = if base > 0.0 { sub(right, left).map(|x| x / base) } else { [1.0, 0.0] };
    let [along, away] = apex(lengths);
    let ahead = if side == GateSide::Ahead { away } else { -away };
    [left[0] + along * x - ahead * y, left[1] + along * y + ahead * x]
}
