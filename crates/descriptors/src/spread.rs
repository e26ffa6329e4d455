//! Points spread evenly over a form.

use nalgebra::Point3;

/// Farthest point sampling in space.
pub(crate) struct Spread {
    /// The samples, farthest first: any leading part of them is evenly spread too.
    pub(crate) samples: Vec<usize>,
    /// For every point, the position in `samples` of the nearest one, the first in case of a tie.
    pub(crate) nearest: Vec<usize>,
    /// No point is farther from the nearest sample.
    pub(crate) covering: f64,
}

/// Chooses up to `n` of the points, the one farthest from the origin first; fewer if points coincide.
///
/// Cost `O(p n)`.
pub(crate) fn spread(points: &[Point3<f64>], n: usize) -> Spread {
    let mut gap: Vec<f64> = points.iter().map(|p| p.coords.norm_squared()).collect();
    let mut nearest = vec![0; points.len()];
    let mut samples = Vec::with_capacity(n.min(points.len()));
    while samples.len() < n.min(points.len()) {
        let (mut next, mut widest) = (0, f64::NEG_INFINITY);
        for (i, g) in gap.iter().enumerate() {
            if *g > widest {
                (next, widest) = (i, *g);
            }
        }
        let first = samples.is_empty();
        if !first && widest == 0.0 {
            break;
        }
        let at = points[next];
        for ((g, owner), p) in gap.iter_mut().zip(&mut nearest).zip(points) {
            let d = (p - at).norm_squared();
            if first || d < *g {
                (*g, *owner) = (d, samples.len());
            }
        }
        samples.push(next);
    }
    let covering = gap.iter().copied().fold(0.0, f64::max).sqrt();
    Spread { samples, nearest, covering }
}
