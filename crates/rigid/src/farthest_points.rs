//! Farthest point sampling in space.

use nalgebra::Point3;

/// Points that are spread evenly over others.
#[derive(Debug, Clone, PartialEq)]
pub struct FarthestPoints {
    /// The samples, farthest first: any leading part of them is evenly spread too.
    pub samples: Vec<usize>,
    /// For every point, the position in `samples` of the nearest one, the first in case of a tie.
    pub nearest: Vec<usize>,
}

/// The points whose nearest sample is the same.
struct Cell {
    members: Vec<usize>,
    /// The member that is farthest from the sample, the first in case of a tie, and the square of its distance.
    farthest: (usize, f64),
}

impl Cell {
    fn new(members: Vec<usize>, gaps: &[f64]) -> Self {
        let farthest = farthest(members.iter().map(|i| (*i, gaps[*i])));
        Self { members, farthest }
    }
}

/// The point with the largest distance, the first in case of a tie.
fn farthest(points: impl Iterator<Item = (usize, f64)>) -> (usize, f64) {
    points.fold(
        (usize::MAX, f64::NEG_INFINITY),
        |a, b| {
            if b.1 > a.1 || (b.1 == a.1 && b.0 < a.0) { b } else { a }
        },
    )
}

/// Chooses up to `n` of the points, the one farthest from the origin first; fewer if points coincide.
pub fn farthest_points(points: &[Point3<f64>], n: usize) -> FarthestPoints {
    let sq_distance = |i: usize, j: usize| (points[i] - points[j]).norm_squared();
    farthest_points_by(points.iter().map(|p| p.coords.norm_squared()), sq_distance, n)
}

/// Chooses up to `n` points by the squares of their distances from the origin and from each other.
///
/// A new sample takes points from cells only whose own sample is less than twice as far away as their farthest member, so
/// that each point is looked at a few times.
pub fn farthest_points_by(
    from_origin: impl Iterator<Item = f64>,
    sq_distance: impl Fn(usize, usize) -> f64,
    n: usize,
) -> FarthestPoints {
    let from_origin: Vec<f64> = from_origin.collect();
    let n_points = from_origin.len();
    let whole = Cell::new((0..n_points).collect(), &from_origin);
    let mut nearest = vec![0; n_points];
    if n == 0 || n_points == 0 {
        return FarthestPoints { samples: Vec::new(), nearest };
    }
    let mut samples = vec![if whole.farthest.0 < n_points { whole.farthest.0 } else { 0 }];
    let mut gaps: Vec<f64> = (0..n_points).map(|i| sq_distance(i, samples[0])).collect();
    let mut cells = vec![Cell::new(whole.members, &gaps)];
    while samples.len() < n.min(n_points) {
        let (next, widest) = farthest(cells.iter().map(|cell| cell.farthest));
        if widest.is_nan() || widest <= 0.0 {
            break;
        }
        let mut taken = Vec::new();
        for (cell, sample) in cells.iter_mut().zip(&samples) {
            // By the triangle inequality, nearer members are nearer to their own sample.
            if sq_distance(*sample, next) >= 4.0 * cell.farthest.1 {
                continue;
            }
            let before = taken.len();
            cell.members.retain(|i| {
                let sq = sq_distance(*i, next);
                let is_nearer = sq < gaps[*i];
                if is_nearer {
                    gaps[*i] = sq;
                    taken.push(*i);
                }
                !is_nearer
            });
            if taken.len() > before {
                *cell = Cell::new(std::mem::take(&mut cell.members), &gaps);
            }
        }
        taken.iter().for_each(|i| nearest[*i] = samples.len());
        cells.push(Cell::new(taken, &gaps));
        samples.push(next);
    }
    FarthestPoints { samples, nearest }
}
