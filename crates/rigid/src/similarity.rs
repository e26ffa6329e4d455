//! Motions, with or without a reflection and a change of size.

use nalgebra::{Matrix3, Point3, Vector3};

type Pair = (Point3<f64>, Point3<f64>);

/// The map `x -> scale rotation x + translation`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Similarity {
    /// An orthogonal matrix; its determinant is -1 when `reflected`.
    pub rotation: Matrix3<f64>,
    /// In the unit of the images.
    pub translation: Vector3<f64>,
    /// Lengths of images over those of points; 1 for a motion.
    pub scale: f64,
    /// Whether the map includes a reflection.
    pub reflected: bool,
}

impl Similarity {
    /// The map that changes nothing.
    pub fn identity() -> Self {
        Self::about_origin(Matrix3::identity())
    }

    /// The motion that applies an orthogonal matrix about the origin.
    pub fn about_origin(rotation: Matrix3<f64>) -> Self {
        let reflected = rotation.determinant() < 0.0;
        Self { rotation, translation: Vector3::zeros(), scale: 1.0, reflected }
    }

    /// The motion about the origin that takes the plane of two vectors to that of two others, and the first to the first, all
    /// of length 1. `None` if two vectors are parallel.
    pub fn between_frames(from: [Vector3<f64>; 2], to: [Vector3<f64>; 2], reflected: bool) -> Option<Self> {
        let frame = |[x, y]: [Vector3<f64>; 2]| {
            let z = x.cross(&y).try_normalize(1e-9)?;
            Some(Matrix3::from_columns(&[x, z.cross(&x), z]))
        };
        let (from, mut to) = (frame(from)?, frame(to)?);
        if reflected {
            to.column_mut(2).neg_mut();
        }
        Some(Self { reflected, ..Self::about_origin(to * from.transpose()) })
    }

    /// Applies the map to a point.
    #[inline]
    pub fn apply(&self, point: &Point3<f64>) -> Point3<f64> {
        Point3::from(self.rotation * (point.coords * self.scale) + self.translation)
    }

    /// The map back.
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.transpose();
        let translation = -(rotation * self.translation) / self.scale;
        Self { rotation, translation, scale: 1.0 / self.scale, reflected: self.reflected }
    }

    /// This map after `first`.
    pub fn after(&self, first: &Self) -> Self {
        Self {
            rotation: self.rotation * first.rotation,
            translation: self.rotation * (first.translation * self.scale) + self.translation,
            scale: self.scale * first.scale,
            reflected: self.reflected != first.reflected,
        }
    }

    /// The motion that minimizes the mean squared distance between the images of the first points and the second points of
    /// `pairs`, with a reflection if and only if `reflected` (Kabsch 1976, by the SVD of the 3 x 3 cross-covariance).
    /// `None` without pairs.
    pub fn fit_motion(pairs: &[Pair], reflected: bool) -> Option<Self> {
        Self::fit(pairs, reflected, |_| 1.0)
    }

    /// The same with the best scale (Umeyama 1991, `umeyama1991` in `REFERENCES.bib`). `None` without pairs, or if the points
    /// of either side coincide.
    pub fn fit_scaled(pairs: &[Pair], reflected: bool) -> Option<Self> {
        Self::fit(pairs, reflected, |[product, square]| product / square)
    }

    /// `scale` of the sum of the products of turned points and partners, and of the squares of the points.
    fn fit(pairs: &[Pair], reflected: bool, scale: impl Fn([f64; 2]) -> f64) -> Option<Self> {
        if pairs.is_empty() {
            return None;
        }
        let n = pairs.len() as f64;
        let sums = pairs.iter().fold([Vector3::zeros(); 2], |[x, y], (p, q)| [x + p.coords, y + q.coords]);
        let [mean_x, mean_y] = sums.map(|sum| sum / n);
        let (mut covariance, mut square) = (Matrix3::zeros(), 0.0);
        for (x, y) in pairs {
            let x = x.coords - mean_x;
            covariance += x * (y.coords - mean_y).transpose();
            square += x.norm_squared();
        }
        let rotation = nearest_rotation(&covariance, reflected)?;
        let scale = scale([(rotation * covariance).trace(), square]);
        let translation = mean_y - rotation * mean_x * scale;
        (scale > 0.0 && scale.is_finite()).then_some(Self { rotation, translation, scale, reflected })
    }
}

/// The rotation `R` that maximises `tr(R C)` for the cross-covariance `C = Σ x y'` of points and what they should be moved to;
/// with a reflection if and only if `reflected`.
pub fn nearest_rotation(covariance: &Matrix3<f64>, reflected: bool) -> Option<Matrix3<f64>> {
    let svd = covariance.svd(true, true);
    let (u, v_t) = (svd.u?, svd.v_t?);
    let mut signs = Vector3::repeat(1.0);
    // nalgebra sorts singular values in descending order: the sign goes to the smallest one.
    let wanted = if reflected { -1.0 } else { 1.0 };
    signs[2] = wanted * (u.determinant() * v_t.determinant()).signum();
    Some(v_t.transpose() * Matrix3::from_diagonal(&signs) * u.transpose())
}
