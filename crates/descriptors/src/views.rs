//! Views of a form: what it looks like from a few directions, whatever its handedness.

use nalgebra::{Matrix3, Point3, Vector3};

use crate::align::axis_motions;
use crate::canonical_form::CanonicalForm;

/// Rows and columns of an image.
const SIDE: usize = 16;

/// Half the side of an image, in the unit of length that gives the surface unit area. Chosen on built-in bodies, with
/// [`PASSES`]: of 84 creatures a window of 1.1, 1.4 and 2 gave an mAP of .83, .85 and .87. Nineteen forms of twenty fit
/// into 1.6.
const HALF_SIDE: f64 = 2.0;

/// Passes of the filter (1, 2, 1) / 4 along either side: together nearly a Gaussian of half that unit of length. Chosen on
/// built-in bodies: of 84 creatures 3, 5, 8 and 12 passes gave an mAP of .867, .876, .880 and .885, of 18 bodies of three
/// families .532, .532, .529 and .523.
const PASSES: usize = 8;

/// The spread of a form of unit area: the median of built-in creatures. It scales forms without a unit of length.
const USUAL_SPREAD: f64 = 0.43;

/// Views of a canonical form: how its area is distributed over the plane, seen from nine directions.
///
/// A view is a blurred image of the form as if it were transparent, in its principal axes, at unit area. Its pixels are shares
/// of the area. The directions are those of the axes and halfway between two of them. Two forms are compared under all
/// signs of the axes and, where their spreads are within 15 %, their exchange: 8 to 48 motions, half of them reflections,
/// since distances determine a form only up to reflection.
///
/// * Invariant to bending, rigid motions, mirror images, the order of vertices and scale; changes with the triangulation as
///   the form does.
/// * **Not continuous** where the spreads of two axes differ by just 15 %.
/// * Needs points with weights only, so views can be made of a stored form. Cost `O(p)`, and 10 µs for a pair.
///
/// Lian et al. 2013 (`lian2013` in `REFERENCES.bib`) compare depth images of forms by bags of local features, under all
/// permutations of the axes. On built-in families that tells bodies apart less well, see `docs/decisions/026-forms-alone.md`.
///
/// ```
/// use canonform_descriptors::{CanonicalForm, FormViews};
/// use nalgebra::Point3;
///
/// let spiral = |turn: f64, hand: f64| {
///     let at = |i: i32| Point3::new(0.1 * f64::from(i), hand * (turn + 0.1 * f64::from(i)).sin(), (turn + 0.1 * f64::from(i)).cos());
///     CanonicalForm::from_points((0..100).map(at).collect(), vec![1.0; 100]).map(|form| FormViews::new(&form))
/// };
/// let difference = spiral(0.0, 1.0)?.distance(&spiral(2.0, -1.0)?);
/// assert!(difference < 1e-3, "one is the mirror image of the other, turned about its axis");
/// # Ok::<(), canonform_descriptors::DescriptorError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct FormViews {
    /// One image for each of [`frames`], row by row.
    images: Vec<Image>,
    /// Standard deviation along each principal axis, descending.
    axis_spread: [f64; 3],
}

type Image = [f32; SIDE * SIDE];

/// Directions to the right and upwards in an image.
type Frame = [Vector3<f64>; 2];

impl FormViews {
    /// The views of a form.
    #[must_use]
    pub fn new(form: &CanonicalForm) -> Self {
        let unit = form.area().map_or_else(|| form.spread() / USUAL_SPREAD, f64::sqrt);
        let (axes, axis_spread) = form.principal_axes();
        let points: Vec<Point3<f64>> = form.points().iter().map(|p| axes * p / unit).collect();
        let image = |frame: &Frame| blurred(image(&points, form.weights(), frame));
        Self { images: frames().iter().map(image).collect(), axis_spread }
    }

    /// The sum of the differences between the pixels of two views, averaged over the views, for the motion that makes it
    /// least: 0 for equal forms, at most 2.
    #[must_use]
    pub fn distance(&self, other: &Self) -> f64 {
        let frames = frames();
        let motions = axis_motions(self.axis_spread, other.axis_spread);
        let differences = motions.iter().map(|motion| self.difference(other, &motion.rotation, &frames));
        differences.fold(f64::INFINITY, f64::min) / frames.len() as f64
    }

    /// The difference of all views if `motion`, a signed permutation, moves this form.
    fn difference(&self, other: &Self, motion: &Matrix3<f64>, frames: &[Frame]) -> f64 {
        let views = frames.iter().zip(&other.images).map(|(frame, image)| {
            // The moved form is seen in a frame as the form itself in the frame that is moved back.
            let back = frame.map(|axis| motion.transpose() * axis);
            let direction = back[0].cross(&back[1]);
            let is_same = |own: &Frame| own[0].cross(&own[1]).dot(&direction).abs() > 0.9;
            let source = frames.iter().position(is_same).unwrap_or(0);
            let turn = back.map(|axis| frames[source].map(|own| own.dot(&axis).round() as i32));
            compared(&self.images[source], image, turn)
        });
        views.sum()
    }
}

/// The frames of all views. Signed permutations of the axes permute the directions of the views, and take the two axes of a
/// frame to those of another, exchanged or reversed.
fn frames() -> [Frame; 9] {
    let axis = |i: usize| Vector3::from(std::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }));
    std::array::from_fn(|view| {
        let (first, second, third) = (axis(view % 3), axis((view + 1) % 3), axis((view + 2) % 3));
        match view / 3 {
            0 => [second, third],
            1 => [first, (second - third).normalize()],
            _ => [first, (second + third).normalize()],
        }
    })
}

/// The sum of the differences of two images, the first turned: its axes to the right and upwards become the rows of `turn`.
fn compared(image: &Image, other: &Image, turn: [[i32; 2]; 2]) -> f64 {
    let centre = SIDE as i32 - 1;
    let mut sum = 0.0;
    for (row, pixels) in other.chunks_exact(SIDE).enumerate() {
        // Positions from the centre, in half pixels.
        let y = 2 * row as i32 - centre;
        let start = [0, 1].map(|k| (turn[1][k] * y - turn[0][k] * centre + centre) / 2);
        let mut at = start[1] * SIDE as i32 + start[0];
        let step = turn[0][1] * SIDE as i32 + turn[0][0];
        let mut differences = 0.0;
        for pixel in pixels {
            differences += (image[at as usize] - pixel).abs();
            at += step;
        }
        sum += f64::from(differences);
    }
    sum
}

/// The shares of the area over the image plane. What is outside the image counts at its rim.
fn image(points: &[Point3<f64>], weights: &[f64], frame: &Frame) -> Image {
    let mut image = [0.0; SIDE * SIDE];
    for (point, weight) in points.iter().zip(weights) {
        let [(column, right), (row, up)] = frame.map(|axis| {
            let at = 0.5 * SIDE as f64 * (1.0 + axis.dot(&point.coords) / HALF_SIDE) - 0.5;
            let at = at.clamp(0.0, (SIDE - 1) as f64);
            let low = (at as usize).min(SIDE - 2);
            (low, at - low as f64)
        });
        for (row, share) in [(row, 1.0 - up), (row + 1, up)] {
            image[row * SIDE + column] += weight * share * (1.0 - right);
            image[row * SIDE + column + 1] += weight * share * right;
        }
    }
    image.map(|share| share as f32)
}

fn blurred(mut image: Image) -> Image {
    for _ in 0..PASSES {
        for step in [1, SIDE] {
            let before = image;
            for (i, pixel) in image.iter_mut().enumerate() {
                let place = i / step % SIDE;
                let lower = if place > 0 { before[i - step] } else { 0.0 };
                let upper = if place + 1 < SIDE { before[i + step] } else { 0.0 };
                *pixel = 0.25 * (lower + upper) + 0.5 * before[i];
            }
        }
    }
    image
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    /// Three arms of different lengths and weights, without symmetry.
    fn figure(bend: f64) -> (Vec<Point3<f64>>, Vec<f64>) {
        let at = |i: usize| {
            let (arm, s) = (i % 3, (i / 3) as f64 / 200.0);
            let point = match arm {
                0 => Point3::new(1.3 * s, bend * s * s, 0.1 * (9.0 * s).sin()),
                1 => Point3::new(-0.6 * s, 0.9 * s, 0.2 * s),
                _ => Point3::new(0.2 * s, -0.5 * s * s, 0.6 * s),
            };
            (point, 1.0 + arm as f64)
        };
        (0..600).map(at).unzip()
    }

    fn views(points: &[Point3<f64>], weights: &[f64], size: f64) -> FormViews {
        let form = CanonicalForm::from_points(points.iter().map(|p| p * size).collect(), weights.to_vec());
        let form = form.unwrap();
        let (points, weights) = (form.points().to_vec(), form.weights().to_vec());
        FormViews::new(&CanonicalForm::from_parts(points, weights, Some(size * size)).unwrap())
    }

    #[test]
    fn moved_mirrored_and_scaled_forms_are_at_distance_zero() {
        let (points, weights) = figure(0.3);
        let own = views(&points, &weights, 1.0);
        let turn = Rotation3::from_euler_angles(1.0, 0.4, -2.0);
        for signs in 0..8 {
            let sign = |k: u32| if signs >> k & 1 == 0 { 1.0 } else { -1.0 };
            let flip = Matrix3::from_diagonal(&Vector3::new(sign(0), sign(1), sign(2)));
            for exchange in [Matrix3::identity(), Matrix3::new(0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)] {
                let moved: Vec<_> = points.iter().map(|p| turn * flip * exchange * p).collect();
                let distance = own.distance(&views(&moved, &weights, 7.0));
                assert!(distance < 1e-4, "{distance}");
            }
        }
    }

    #[test]
    fn near_equal_axes_may_be_exchanged() {
        // A cross whose arms differ in their ends, and whose spreads are 5 % apart in the other order.
        let cross = |x: f64, y: f64| {
            let at = |i: i32| {
                let s = f64::from(i) / 100.0;
                let long = s + 0.3 * (s * s - 0.3);
                [
                    Point3::new(x * s, 0.05, 0.0),
                    Point3::new(0.0, y * long, 0.0),
                    Point3::new(0.02, 0.0, 0.2 * s),
                ]
            };
            let points: Vec<_> = (-100..100).flat_map(at).collect();
            let weights = vec![1.0; points.len()];
            views(&points, &weights, 1.0)
        };
        let spread = |views: &FormViews| views.axis_spread;
        let (a, b) = (cross(1.0, 0.9), cross(1.0, 0.98));
        assert!(spread(&a)[0] < 1.15 * spread(&a)[1] && spread(&b)[0] < 1.15 * spread(&b)[1]);
        let fixed = a.difference(&b, &Matrix3::identity(), &frames()) / 9.0;
        assert!(a.distance(&b) < 0.1 && a.distance(&b) <= fixed);
    }

    #[test]
    fn the_distance_is_symmetric_and_grows_with_the_difference() {
        let (points, weights) = figure(0.3);
        let own = views(&points, &weights, 1.0);
        let mut last = 0.0;
        for bend in [0.4, 0.7, 1.2] {
            let (points, weights) = figure(bend);
            let other = views(&points, &weights, 1.0);
            let distance = own.distance(&other);
            assert!((distance - other.distance(&own)).abs() < 1e-5);
            assert!(distance > last + 1e-3 && distance <= 2.0, "{bend}: {distance}");
            last = distance;
        }
    }

    #[test]
    fn points_that_are_split_or_exchanged_change_nothing() {
        let (points, weights) = figure(0.3);
        let own = views(&points, &weights, 1.0);
        let halves = |w: &Vec<f64>| w.iter().chain(w).map(|w| 0.5 * w).collect::<Vec<_>>();
        let mut doubled: Vec<_> = points.iter().chain(&points).copied().collect();
        let mut split = halves(&weights);
        doubled.reverse();
        split.reverse();
        assert!(own.distance(&views(&doubled, &split, 1.0)) < 1e-4);
    }

    #[test]
    fn images_hold_the_whole_area_and_turn_with_the_form() {
        let (points, weights) = figure(0.3);
        let own = views(&points, &weights, 1.0);
        assert!(own.images.iter().all(|image| (image.iter().sum::<f32>() - 1.0).abs() < 0.01));
        // Against the images of the moved points themselves.
        let form = CanonicalForm::from_points(points, weights).unwrap();
        let drawn = |motion: &Matrix3<f64>| {
            let moved: Vec<Point3<f64>> = form.points().iter().map(|p| motion * p).collect();
            let images = frames().map(|frame| blurred(image(&moved, form.weights(), &frame)));
            FormViews { images: images.to_vec(), axis_spread: [1.0; 3] }
        };
        let start = drawn(&Matrix3::identity());
        for motion in axis_motions([1.0; 3], [1.0; 3]) {
            let difference = start.difference(&drawn(&motion.rotation), &motion.rotation, &frames());
            assert!(difference < 1e-4, "{}: {difference}", motion.rotation);
        }
    }

    #[test]
    fn forms_far_beyond_the_image_still_differ() {
        let line = |length: f64, heavy: f64| {
            let points: Vec<_> =
                (0..100).map(|i| Point3::new(length * f64::from(i), 0.1 * f64::from(i % 3), 0.0)).collect();
            let weights: Vec<f64> = (0..100).map(|i| if i < 10 { heavy } else { 1.0 }).collect();
            views(&points, &weights, 1.0)
        };
        let (even, uneven) = (line(1.0, 1.0), line(1.0, 20.0));
        assert!(even.images.iter().flatten().all(|pixel| pixel.is_finite()));
        assert!(even.distance(&uneven) > 0.05);
    }
}
