//! Patches: quadrics over planes, fitted to points.

use nalgebra::{Matrix3, Matrix6, Point3, Vector3, Vector6};

/// Orthonormal axes of a tangent plane, and its normal.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) u: Vector3<f64>,
    pub(super) v: Vector3<f64>,
    pub(super) normal: Vector3<f64>,
}

impl Frame {
    /// The frame whose normal is the direction in which weighted points spread least.
    pub(super) fn of(points: &[(Point3<f64>, f64)]) -> Self {
        let total: f64 = points.iter().map(|(_, w)| w).sum();
        let mean = points.iter().map(|(p, w)| p.coords * *w).sum::<Vector3<f64>>() / total;
        let mut spread = Matrix3::zeros();
        for (p, w) in points {
            let d = p.coords - mean;
            spread += d * d.transpose() * *w;
        }
        let axes = spread.symmetric_eigen();
        let least = axes.eigenvalues.imin();
        // Turned so that equal planes have equal frames.
        let normal = axes.eigenvectors.column(least).try_normalize(0.0).unwrap_or_else(Vector3::z);
        let u = normal.cross(&Vector3::ith(normal.iamin(), 1.0)).normalize();
        Self { u, v: normal.cross(&u), normal }
    }

    /// Coordinates in the plane, and height over it.
    pub(super) fn coordinates(&self, d: &Vector3<f64>) -> [f64; 3] {
        [self.u.dot(d), self.v.dot(d), self.normal.dot(d)]
    }
}

/// Rounds in which points that are far from the patch lose weight.
const ROUNDS: usize = 3;

/// The patch at a place, fitted to points that are sorted by distance. Points near the place count more, and those farther from
/// the patch than three times the residual of most of them hardly count: they belong to other parts of the surface.
/// `None` for fewer than seven points.
///
/// Returns the place, moved along the normal of its plane onto the patch, and the weighted root mean square height of the
/// points over the patch, corrected for the degrees of freedom.
pub(super) fn patch(place: &Point3<f64>, near: &[Point3<f64>]) -> Option<(Point3<f64>, f64)> {
    let n = near.len();
    if n < 7 {
        return None;
    }
    let radius = (near[n - 1] - place).norm();
    if radius <= 0.0 {
        return None;
    }
    // A Gaussian that has fallen to exp(-2) at the farthest point.
    let by_distance = |p: &Point3<f64>| (-2.0 * ((p - place).norm() / radius).powi(2)).exp();
    let mut weighted: Vec<(Point3<f64>, f64)> = near.iter().map(|p| (*p, by_distance(p))).collect();
    let frame = Frame::of(&weighted);
    let rows: Vec<([f64; 6], f64, f64)> = weighted
        .drain(..)
        .map(|(p, w)| {
            let [u, v, h] = frame.coordinates(&((p - place) / radius));
            ([1.0, u, v, u * u, u * v, v * v], h, w)
        })
        .collect();
    let mut trust = vec![1.0; n];
    let (mut gaps, mut order) = (Vec::with_capacity(n), Vec::with_capacity(n));
    let mut found = None;
    for _ in 0..ROUNDS {
        let mut normal = Matrix6::<f64>::zeros();
        let mut right = Vector6::<f64>::zeros();
        for ((row, h, w), t) in rows.iter().zip(&trust) {
            for i in 0..6 {
                let weighted = w * t * row[i];
                right[i] += weighted * h;
                // Only the lower triangle is read.
                for j in i..6 {
                    normal[(j, i)] += weighted * row[j];
                }
            }
        }
        // Keeps the fit to few or aligned points bounded: their heights are those of a plane.
        let slight = 1e-6 * normal.trace();
        for i in 0..6 {
            normal[(i, i)] += slight;
        }
        let Some(solver) = normal.cholesky() else { break };
        let c = solver.solve(&right);
        let gap = |row: &[f64; 6], h: f64| h - row.iter().zip(c.iter()).map(|(x, c)| x * c).sum::<f64>();
        gaps.clear();
        gaps.extend(rows.iter().map(|(row, h, _)| gap(row, *h).abs()));
        let (mut sum, mut total) = (0.0, 0.0);
        for (((_, _, w), t), gap) in rows.iter().zip(&trust).zip(&gaps) {
            sum += w * t * gap * gap;
            total += w * t;
        }
        let freedom = n as f64 / (n as f64 - 6.0);
        order.clone_from(&gaps);
        found = Some((c[0], (sum / total * freedom).sqrt()));
        let (_, middle, _) = order.select_nth_unstable_by(n / 2, f64::total_cmp);
        // The median of the absolute value of a normal deviate is 0.67 of its standard deviation.
        let limit = 3.0 * (*middle / 0.6745).max(1e-9);
        for (gap, t) in gaps.iter().zip(&mut trust) {
            *t = (1.0 + (gap / limit).powi(2)).powi(-2);
        }
    }
    let (height, residual) = found?;
    Some((place + frame.normal * (height * radius), residual * radius))
}
