//! The triangles around every point, in its tangent plane.

use nalgebra::Point3;
use rayon::prelude::*;

use super::fit::Frame;
use crate::box_tree::BoxTree;

/// Neighbors whose plane is the tangent plane.
const TANGENT: usize = 16;

/// Neighbors among which a point looks for triangles. Of points spread at random, one in 10,000 empty circles is larger than
/// half the radius of 48 neighbors.
const NEAR: usize = 48;

/// Least cosine of the angle between the normals of neighbors on the same part of a surface.
const ALIKE: f64 = 0.5;

/// Largest share of the distance of a neighbor that is height over the tangent plane.
const STEEPEST: f64 = 0.8;

/// A triangle that a point proposes: its corners, ascending, and the radius of its circle.
pub(super) type Proposal = ([u32; 3], f64);

/// The triangles that every point proposes, and the directions in which it sees its neighbors.
pub(super) struct Stars {
    pub(super) frames: Vec<Frame>,
    pub(super) points: Vec<Point3<f64>>,
    pub(super) proposals: Vec<Proposal>,
}

impl Stars {
    /// The direction in the tangent plane of one point to another, as an angle.
    pub(super) fn angle(&self, at: u32, to: u32) -> f64 {
        let d = self.points[to as usize] - self.points[at as usize];
        let [x, y, _] = self.frames[at as usize].coordinates(&d);
        y.atan2(x)
    }
}

/// The stars of all points.
pub(super) fn stars(points: &[Point3<f64>]) -> Stars {
    let tree = BoxTree::new(points.iter().copied().zip(0..));
    let near: Vec<Vec<(f64, u32)>> = points.par_iter().map(|p| tree.nearest(p, NEAR + 1)).collect();
    let frames: Vec<Frame> = near
        .par_iter()
        .map(|near| {
            let around: Vec<(Point3<f64>, f64)> =
                near.iter().take(TANGENT + 1).map(|(_, i)| (points[*i as usize], 1.0)).collect();
            Frame::of(&around)
        })
        .collect();
    let star = |center: usize| {
        let reach = near[center].last().map_or(0.0, |(sq, _)| sq.sqrt());
        let frame = &frames[center];
        let mut seen: Vec<(u32, [f64; 2])> = Vec::with_capacity(NEAR);
        for &(sq, i) in &near[center] {
            let length = sq.sqrt();
            if i as usize == center || frames[i as usize].normal.dot(&frame.normal).abs() < ALIKE {
                continue;
            }
            let [x, y, h] = frame.coordinates(&(points[i as usize] - points[center]));
            let flat = x.hypot(y);
            if flat > 0.0 && h.abs() <= STEEPEST * length {
                // Unrolls the surface: the distance stays.
                seen.push((i, [x * length / flat, y * length / flat]));
            }
        }
        cell(&seen, reach)
            .into_iter()
            .map(|([a, b], radius)| {
                let mut face = [center as u32, a, b];
                face.sort_unstable();
                (face, radius)
            })
            .collect::<Vec<_>>()
    };
    let proposals: Vec<Vec<Proposal>> = (0..points.len()).into_par_iter().map(star).collect();
    Stars { frames, points: points.to_vec(), proposals: proposals.concat() }
}

/// A side of a Voronoi cell begins at a corner and belongs to a neighbor, or to the frame around the cell.
#[derive(Debug, Clone, Copy)]
struct Side {
    from: [f64; 2],
    neighbor: Option<u32>,
}

/// The corners of the Voronoi cell of the origin among points that are sorted by distance and known up to `reach`: the
/// two neighbors of each, and its distance from the origin, the radius of the circle through the origin and both.
fn cell(points: &[(u32, [f64; 2])], reach: f64) -> Vec<([u32; 2], f64)> {
    let r = 2.0 * reach;
    let corner = |from| Side { from, neighbor: None };
    let mut sides = vec![corner([r, -r]), corner([r, r]), corner([-r, r]), corner([-r, -r])];
    let mut cut = Vec::new();
    for &(neighbor, [x, y]) in points {
        let half = 0.5 * (x * x + y * y);
        let beyond = |p: [f64; 2]| p[0] * x + p[1] * y - half;
        let heights: Vec<f64> = sides.iter().map(|side| beyond(side.from)).collect();
        if heights.iter().all(|h| *h <= 0.0) {
            continue;
        }
        cut.clear();
        let n = sides.len();
        for i in 0..n {
            let (side, next) = (sides[i], sides[(i + 1) % n].from);
            let (a, b) = (heights[i], heights[(i + 1) % n]);
            let meet = || {
                let t = a / (a - b);
                [side.from[0] + t * (next[0] - side.from[0]), side.from[1] + t * (next[1] - side.from[1])]
            };
            match (a <= 0.0, b <= 0.0) {
                (true, true) => cut.push(side),
                (true, false) => cut.extend([side, Side { from: meet(), neighbor: Some(neighbor) }]),
                (false, true) => cut.push(Side { from: meet(), ..side }),
                (false, false) => {}
            }
        }
        std::mem::swap(&mut sides, &mut cut);
    }
    let n = sides.len();
    (0..n)
        .filter_map(|i| {
            let (before, side) = (sides[(i + n - 1) % n], sides[i]);
            let radius = side.from[0].hypot(side.from[1]);
            match (before.neighbor, side.neighbor) {
                // Points farther than `reach` could lie in a larger circle.
                (Some(a), Some(b)) if a != b && 2.0 * radius <= reach => Some(([a, b], radius)),
                _ => None,
            }
        })
        .collect()
}
