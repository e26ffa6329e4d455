//! Triangles of planar polygons with holes.

use std::collections::HashMap;

use earcut::Earcut;

use super::options::Diagonals;

type Triangle = [usize; 3];

/// Triangulates the polygon of the first loop without the others, counter-clockwise; names points by their number in
/// the concatenated loops. Every point is a corner of a triangle, also one in a row with others.
pub(super) fn triangulate(points: &[[f64; 2]], hole_starts: &[usize], diagonals: Diagonals) -> Vec<Triangle> {
    let mut cut = Vec::new();
    Earcut::new().earcut(nudged(points), hole_starts, &mut cut);
    let mut triangles: Vec<Triangle> = cut.chunks_exact(3).map(|t| [t[0], t[1], t[2]]).collect();
    if triangles.iter().map(|&t| twice_area(points, t)).sum::<f64>() < 0.0 {
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    let good_enough = match diagonals {
        Diagonals::Clipped => 1e-6,
        Diagonals::Even => f64::INFINITY,
    };
    while flip_some(points, &mut triangles, good_enough) {}
    triangles
}

/// The points moved by 1e-7 of their extent: ear clipping drops points in a row with their neighbors, which would leave
/// gaps beside the faces that share their edges.
fn nudged(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let extent = points.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    let nudge = |i: usize, ratio: f64| 1e-7 * extent * ((i as f64 * ratio).fract() - 0.5);
    let moved = |(i, p): (usize, &[f64; 2])| [p[0] + nudge(i + 1, 0.618_034), p[1] + nudge(i + 1, 0.754_878)];
    points.iter().enumerate().map(moved).collect()
}

/// Flips edges of triangles below a quality where that improves the worse triangle. Whether it flipped any.
///
/// Every flip replaces two triangles by better ones than the worse, so there cannot be infinitely many.
fn flip_some(points: &[[f64; 2]], triangles: &mut [Triangle], good_enough: f64) -> bool {
    let mut owner: HashMap<[usize; 2], usize> = HashMap::new();
    for (t, triangle) in triangles.iter().enumerate() {
        owner.extend((0..3).map(|i| ([triangle[i], triangle[(i + 1) % 3]], t)));
    }
    let mut any = false;
    for t in 0..triangles.len() {
        for i in 0..3 {
            let [a, b, c] = [0, 1, 2].map(|k| triangles[t][(i + k) % 3]);
            let Some(&other) = owner.get(&[b, a]) else { continue };
            let Some(&d) = triangles[other].iter().find(|&&v| v != a && v != b) else { continue };
            let worse = |one, two| quality(points, one).min(quality(points, two));
            let before = worse([a, b, c], [b, a, d]);
            if before < good_enough && worse([a, d, c], [d, b, c]) > before + 1e-9 {
                (triangles[t], triangles[other]) = ([a, d, c], [d, b, c]);
                owner.remove(&[a, b]);
                owner.remove(&[b, a]);
                owner.extend([([a, d], t), ([d, c], t), ([c, a], t)]);
                owner.extend([([d, b], other), ([b, c], other), ([c, d], other)]);
                any = true;
                break;
            }
        }
    }
    any
}

fn twice_area(points: &[[f64; 2]], [a, b, c]: Triangle) -> f64 {
    let [a, b, c] = [a, b, c].map(|v| points[v]);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Least height relative to the longest edge, negative if the triangle is turned over.
fn quality(points: &[[f64; 2]], triangle: Triangle) -> f64 {
    let sq_length = |i: usize| {
        let [a, b] = [triangle[i], triangle[(i + 1) % 3]].map(|v| points[v]);
        (b[0] - a[0]).powi(2) + (b[1] - a[1]).powi(2)
    };
    twice_area(points, triangle) / (0..3).map(sq_length).fold(f64::MIN_POSITIVE, f64::max)
}
