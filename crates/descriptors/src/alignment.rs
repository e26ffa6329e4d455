//! Rigid motions, with or without a reflection.

use nalgebra::{Matrix3, Point3, Vector3};

/// The motion `x -> rotation x + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Alignment {
    /// An orthogonal matrix; its determinant is -1 when `reflected`.
    pub rotation: Matrix3<f64>,
    /// In the unit of the points.
    pub translation: Vector3<f64>,
    /// Whether the motion includes a reflection.
    pub reflected: bool,
}

impl Alignment {
    /// The motion that applies an orthogonal matrix about the origin.
    pub fn about_origin(rotation: Matrix3<f64>) -> Self {
        Self { rotation, translation: Vector3::zeros(), reflected: rotation.determinant() < 0.0 }
    }

    /// Applies the motion to a point.
    #[inline]
    #[must_use]
    pub fn apply(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.rotation * point.coords + self.translation)
    }

    /// The inverse motion.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        Self { rotation, translation: -(rotation * self.translation), reflected: self.reflected }
    }

    /// This motion after `first`.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        Self {
            rotation: self.rotation * first.rotation,
            translation: self.rotation * first.translation + self.translation,
            reflected: self.reflected != first.reflected,
        }
    }

    /// The motion that minimises the mean squared distance between the moved first points and the second points of
    /// `pairs`, with a reflection if and only if `reflected` (Kabsch 1976, by the SVD of the 3 x 3 cross-covariance).
    /// `None` without pairs.
    pub fn fit(pairs: &[(Point3<f64>, Point3<f64>)], reflected: bool) -> Option<Self> {
        if pairs.is_empty() {
            return None;
        }
        let n = pairs.len() as f64;
        let (sum_x, sum_y) = pairs
            .iter()
            .fold((Vector3::zeros(), Vector3::zeros()), |(x, y), (p, q)| (x + p.coords, y + q.coords));
        let (mean_x, mean_y) = (sum_x / n, sum_y / n);
        let mut covariance = Matrix3::zeros();
        for (x, y) in pairs {
            covariance += (x.coords - mean_x) * (y.coords - mean_y).transpose();
        }
        let rotation = nearest_rotation(&covariance, reflected)?;
        Some(Self { rotation, translation: mean_y - rotation * mean_x, reflected })
    }
}

/// The rotation `R` that maximises `tr(R C)` for the cross-covariance `C = Σ x y'` of points and what they should be moved to;
/// with a reflection if and only if `reflected`.
pub(crate) fn nearest_rotation(covariance: &Matrix3<f64>, reflected: bool) -> Option<Matrix3<f64>> {
    let svd = covariance.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut signs = Vector3::repeat(1.0);
    // nalgebra sorts singular values in descending order: the sign goes to the smallest one.
    let wanted = if reflected { -1.0 } else { 1.0 };
    signs[2] = wanted * (u.determinant() * v_t.determinant()).signum();
    Some(v_t.transpose() * Matrix3::from_diagonal(&signs) * u.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    #[test]
    fn fit_recovers_a_motion_and_its_inverse_undoes_it() {
        let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
        let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
        for rotation in [turn, turn * mirror] {
            let mut motion = Alignment::about_origin(rotation);
            motion.translation = Vector3::new(1.0, 2.0, -3.0);
            let points: Vec<_> = (0..20)
                .map(f64::from)
                .map(|i| Point3::new((i * 1.3).sin(), (i * 0.7).cos() * 2.0, (i * i * 0.1).sin() * 0.5))
                .collect();
            let pairs: Vec<_> = points.iter().map(|p| (*p, motion.apply(p))).collect();
            let fit = Alignment::fit(&pairs, motion.reflected).unwrap();
            assert!((fit.rotation - motion.rotation).norm() < 1e-13);
            assert!((fit.translation - motion.translation).norm() < 1e-13);
            let identity = fit.inverse().after(&motion);
            assert!((identity.rotation - Matrix3::identity()).norm() < 1e-13);
            assert!(identity.translation.norm() < 1e-13 && !identity.reflected);
            let wrong = Alignment::fit(&pairs, !motion.reflected).unwrap();
            assert!((wrong.rotation.determinant() + motion.rotation.determinant()).abs() < 1e-12);
        }
        assert_eq!(Alignment::fit(&[], false), None);
    }
}
