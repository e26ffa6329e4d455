//! The numbers of two shapes side by side.

use descriptors::{CanonicalForm, DescriptorError, ShapeDistance, ShapeMetric, ShapePair};
use nalgebra::Point3;
use rigid::{NearestPoints, Reflections, Similarity};
use serde::Serialize;

use crate::error::Error;

/// How far apart two shapes are, and how their forms align.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Distance between the aligned forms, in mesh units.
    pub distance: f64,
    /// Distance between the aligned forms once both have unit area: 0 for the same shape at any size.
    pub normalized_distance: f64,
    /// Value of `normalized_distance` from which on shapes with these signatures are of different classes rather than of one;
    /// 0 if the signatures alone are too far apart.
    pub same_below: f64,
    /// The distances that the shapes are related by.
    #[serde(flatten)]
    pub shape_distance: ShapeDistance,
    /// Size of the second surface over that of the first, by the square roots of their areas.
    pub scale: f64,
    /// Whether the best motion includes a reflection.
    pub reflected: bool,
    /// `normalized_distance` if only motions without reflection are allowed.
    pub unreflected_distance: f64,
    /// Rows of the matrix that turns the first form onto the second.
    pub rotation: [[f64; 3]; 3],
    /// The translation after the rotation, in mesh units.
    pub translation: [f64; 3],
}

impl Comparison {
    /// Compares the forms of a pair; `distance` is the one that the shapes are related by.
    pub(crate) fn new(pair: &ShapePair<'_>, distance: ShapeDistance) -> Result<Self, Error> {
        let (best, proper, raw) = (pair.best(), pair.best_with(Reflections::Forbid), pair.align_raw()?);
        let Similarity { rotation, translation, reflected, .. } = raw.map;
        Ok(Self {
            distance: raw.gap.rms,
            normalized_distance: best.gap.rms,
            same_below: ShapeMetric::same_below(distance.combined, best.gap.rms),
            shape_distance: distance,
            scale: pair.scale(),
            reflected,
            unreflected_distance: proper.gap.rms.max(best.gap.rms),
            rotation: [0, 1, 2].map(|i| [0, 1, 2].map(|j| rotation[(i, j)])),
            translation: translation.into(),
        })
    }
}

/// Compares the shapes of a pair, without their surfaces.
///
/// ```
/// use canonform::descriptors::ShapePair;
/// use canonform::{DescribeOptions, Surface, describe};
/// use canonform::compare::compare;
/// use canonform::mesh::shapes;
///
/// let sheet = shapes::grid(21, 17, 0.1);
/// let [flat, folded, ball] = [&sheet, &shapes::fold(&sheet, 0.8, 1.2), &shapes::icosphere(3)].map(|mesh| {
///     let surface = Surface::new(mesh, &Default::default(), &())?;
///     let options = DescribeOptions::default();
///     options.prepare(&describe(&surface, &options, &())?)
/// });
/// let flat = flat?;
/// assert!(compare(&ShapePair::new([&flat, &folded?]))?.shape_distance.is_same_shape());
/// assert!(compare(&ShapePair::new([&flat, &ball?]))?.shape_distance.is_different());
/// # Ok::<(), canonform::Error>(())
/// ```
///
/// # Errors
/// [`Error::Descriptor`].
pub fn compare(pair: &ShapePair<'_>) -> Result<Comparison, Error> {
    Comparison::new(pair, pair.distance())
}

/// Whether two meshes have the same triangles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum FaceAgreement {
    /// The same faces over the same vertex numbers: one mesh in two poses.
    Same,
    /// Different faces or vertex numbers.
    Other,
}

/// Two aligned forms at the size of the first, in units of its mesh, at the position of the second.
#[derive(Debug, Clone, PartialEq)]
pub struct Overlay {
    /// The points of either form.
    pub points: [Vec<Point3<f64>>; 2],
    /// For every point of either form, the distance to the nearest point of the other.
    pub residuals: [Vec<f64>; 2],
}

/// The distances of the points of one form or mesh from the other, in brief.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Residual {
    /// The median; of two in the middle, the upper one.
    pub median: f64,
    /// The largest distance.
    pub max: f64,
    /// The point with the largest distance; the last of equals.
    #[serde(skip)]
    pub max_point: usize,
}

impl Overlay {
    /// Aligns two forms by the best alignment of a pair. The forms may have more points than those that
    /// were aligned.
    ///
    /// # Errors
    /// [`Error::Descriptor`].
    pub fn new(pair: &ShapePair<'_>, forms: [&CanonicalForm; 2]) -> Result<Self, Error> {
        let (motion, [a, b]) = (pair.best().map, pair.shapes);
        let size = a.size();
        let nearest = |points| NearestPoints::new(points).map_err(DescriptorError::from);
        let moved = a.at_unit_area(forms[0]).iter().map(|p| motion.apply(p)).collect();
        let (a, b) = (nearest(moved)?, nearest(b.at_unit_area(forms[1]))?);
        let residuals = |from: &NearestPoints, to: &NearestPoints| {
            from.points().iter().map(|p| to.nearest(p).1.sqrt() * size).collect()
        };
        let points = |form: &NearestPoints| form.points().iter().map(|p| p * size).collect();
        Ok(Self { points: [points(&a), points(&b)], residuals: [residuals(&a, &b), residuals(&b, &a)] })
    }

    /// The residuals of both forms, in brief; zero for a form without points.
    pub fn residual(&self) -> [Residual; 2] {
        self.residuals.each_ref().map(|residuals| Residual::new(residuals))
    }
}

impl Residual {
    /// Of distances; zero if there are none.
    pub fn new(distances: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..distances.len()).collect();
        order.sort_by(|&i, &j| distances[i].total_cmp(&distances[j]));
        let Some(&max_point) = order.last() else { return Self::default() };
        Self { median: distances[order[order.len() / 2]], max: distances[max_point], max_point }
    }
}
