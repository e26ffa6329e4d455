//! Overall dimensions of a part, wherever it lies.

use mesh::{SmoothRegions, circle_through};
use nalgebra::{Point3, Vector2, Vector3};

/// Extents along a direction and across it, descending. Those across are the sides of the smallest rectangle around what is seen
/// along the direction, or the diameter if that is a circle.
pub(super) fn extents(points: &[Point3<f64>], direction: &Vector3<f64>) -> [f64; 3] {
    let right = direction.cross(&Vector3::ith(direction.iamin(), 1.0)).normalize();
    let up = direction.cross(&right);
    let seen = |p: &Point3<f64>| Vector2::new(p.coords.dot(&right), p.coords.dot(&up));
    let outline = hull(points.iter().map(seen).collect());
    let [width, height] = diameter(&outline).map_or_else(|| rectangle(&outline), |diameter| [diameter; 2]);
    let mut extents = [length(points.iter().map(|p| p.coords.dot(direction))), width, height];
    extents.sort_by(|a, b| b.total_cmp(a));
    extents
}

fn length(values: impl Iterator<Item = f64> + Clone) -> f64 {
    values.clone().fold(f64::NEG_INFINITY, f64::max) - values.fold(f64::INFINITY, f64::min)
}

/// Twice the area of the triangle of three points, positive if they turn left.
fn turn(a: &Vector2<f64>, b: &Vector2<f64>, c: &Vector2<f64>) -> f64 {
    (b - a).perp(&(c - a))
}

/// The corners of the convex hull, to the left (Andrew's monotone chain).
fn hull(mut points: Vec<Vector2<f64>>) -> Vec<Vector2<f64>> {
    points.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
    let chain = |points: &mut dyn Iterator<Item = &Vector2<f64>>| {
        let mut chain: Vec<Vector2<f64>> = Vec::new();
        for p in points {
            while let [.., a, b] = chain[..]
                && turn(&a, &b, p) <= 0.0
            {
                chain.pop();
            }
            chain.push(*p);
        }
        // The first corner of the other chain.
        chain.pop();
        chain
    };
    let below = chain(&mut points.iter());
    let above = chain(&mut points.iter().rev());
    below.into_iter().chain(above).collect()
}

fn sides(outline: &[Vector2<f64>]) -> impl Iterator<Item = [Vector2<f64>; 2]> + Clone {
    outline.iter().zip(outline.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

/// The diameter of an outline that is a circle.
fn diameter(outline: &[Vector2<f64>]) -> Option<f64> {
    let (center, radius) = circle_through(outline)?;
    let least = (1.0 - SmoothRegions::ROUND) * radius;
    sides(outline).all(|[a, b]| (0.5 * (a + b) - center).norm() > least).then_some(2.0 * radius)
}

/// The sides of the rectangle with the least area around an outline. It has one of its sides on one of the outline.
fn rectangle(outline: &[Vector2<f64>]) -> [f64; 2] {
    let around = |[a, b]: [Vector2<f64>; 2]| {
        let along = (b - a).try_normalize(0.0)?;
        let across = Vector2::new(-along.y, along.x);
        Some([along, across].map(|axis| length(outline.iter().map(|p| p.dot(&axis)))))
    };
    let area = |[width, height]: &[f64; 2]| width * height;
    sides(outline).filter_map(around).min_by(|x, y| area(x).total_cmp(&area(y))).unwrap_or_default()
}
