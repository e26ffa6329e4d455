//! How well a map keeps distances around every vertex.

use linalg::Matrix;
use nalgebra::DVectorView;
use rayon::prelude::*;

use crate::nearest_rows::PROBED;
use crate::shape::MapShape;
use descriptors::DescriptorError;

/// The [confidence] of every vertex of the first surface in a map that takes it to an image. `units` are the lengths of one at
/// unit area of the surfaces, in the same unit.
pub(crate) fn vertex_confidence(
    [a, b]: [&MapShape; 2],
    units: [f64; 2],
    images: &[usize],
) -> Result<Vec<f64>, DescriptorError> {
    let (on_a, on_b) = (a.all_distances()? * units[0], b.distances_to(images)? * units[1]);
    Ok(confidence(&on_a, a.landmarks(), &on_b))
}

/// A confidence for every vertex of the first surface, from 0 to 1: one less the relative change of its distances to the
/// nearest landmarks, `1 - Σ|d_B - d_A| / Σ d_A`, at least 0.
///
/// It is 1 for an isometry, and 0 where the map is torn, or takes a region to a point. A map that is wrong everywhere in the
/// same smooth way, as one that turns a body back to front, keeps distances, and its vertices are confident.
///
/// * `on_a` has the distances of the landmarks of the first surface to its vertices, a column for each vertex, and `landmarks`
///   these landmarks;
/// * `on_b` has the distances of the landmarks of the second surface to the images of these vertices. Two images are at
///   least as far apart as their distances to any landmark differ; the largest difference stands for their distance.
fn confidence(on_a: &Matrix, landmarks: &[usize], on_b: &Matrix) -> Vec<f64> {
    let one = |x: usize| {
        let from_x = on_a.column(x);
        let mut near: Vec<usize> = (0..landmarks.len()).filter(|l| landmarks[*l] != x).collect();
        near.sort_unstable_by(|k, l| from_x[*k].total_cmp(&from_x[*l]).then(k.cmp(l)));
        near.truncate(PROBED);
        let change =
            |l: &usize| (least_distance(on_b.column(x), on_b.column(landmarks[*l])) - from_x[*l]).abs();
        let [changes, all] = [near.iter().map(change).sum(), near.iter().map(|l| from_x[*l]).sum::<f64>()];
        if all > 0.0 { f64::max(1.0 - changes / all, 0.0) } else { 1.0 }
    };
    (0..on_a.ncols()).into_par_iter().map(one).collect()
}

/// How far points are apart from others at least, on average: from their distances to the same landmarks, a column for each.
pub(crate) fn mean_gap(points: &Matrix, others: &Matrix) -> f64 {
    let gaps = points.column_iter().zip(others.column_iter()).map(|(p, q)| least_distance(p, q));
    gaps.sum::<f64>() / points.ncols() as f64
}

/// Distances between points from those to the same landmarks, a column for each point: the mean of what the triangle
/// inequality allows at least and at most. With 100 landmarks on a built-in man it is 0.2 % of the square root of the area from the truth.
pub(crate) fn between(xs: &Matrix, ys: &Matrix) -> Matrix {
    let n = xs.nrows();
    let column = |y: usize| -> Vec<f64> {
        let of_y = ys.column(y);
        let of_y = of_y.as_slice();
        let one = |x: &[f64]| {
            let (mut least, mut most) = (0.0f64, f64::INFINITY);
            for (p, q) in x.iter().zip(of_y) {
                least = least.max((p - q).abs());
                most = most.min(p + q);
            }
            0.5 * (least + most)
        };
        xs.as_slice().chunks_exact(n.max(1)).map(one).collect()
    };
    let columns: Vec<Vec<f64>> = (0..ys.ncols()).into_par_iter().map(column).collect();
    Matrix::from_vec(xs.ncols(), ys.ncols(), columns.concat())
}

/// The least possible distance of two points, from their distances to the same landmarks.
pub(crate) fn least_distance(p: DVectorView<'_, f64>, q: DVectorView<'_, f64>) -> f64 {
    p.iter().zip(&q).map(|(p, q)| (p - q).abs()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Point2, Rotation2};

    fn sheet(n: usize) -> Vec<Point2<f64>> {
        (0..n * n).map(|i| Point2::new((i % n) as f64, (i / n) as f64) / n as f64).collect()
    }

    /// The confidence of a map of a flat sheet into the plane.
    fn of(map: impl Fn(Point2<f64>) -> Point2<f64>) -> Vec<f64> {
        let points = sheet(30);
        let landmarks: Vec<usize> = (0..points.len()).step_by(17).collect();
        let images: Vec<_> = points.iter().map(|p| map(*p)).collect();
        let distances = |from: &[Point2<f64>], to: &[Point2<f64>]| {
            Matrix::from_fn(from.len(), to.len(), |i, j| (from[i] - to[j]).norm())
        };
        let some: Vec<_> = landmarks.iter().map(|l| points[*l]).collect();
        // Landmarks of the plane around all images.
        let marks: Vec<_> = sheet(12).iter().map(|p| p * 6.0 - nalgebra::Vector2::new(2.0, 2.0)).collect();
        confidence(&distances(&some, &points), &landmarks, &distances(&marks, &images))
    }

    #[test]
    fn stretching_lowers_the_confidence_of_an_isometry_by_as_much() {
        let turn = Rotation2::new(0.7);
        assert!(of(|p| Point2::new(1.0 - p.x, p.y)).iter().all(|c| *c > 0.95 && *c <= 1.0));
        assert!(of(|p| turn * p).iter().all(|c| *c > 0.95));
        assert!(of(|p| p * 1.3).iter().all(|c| (c - 0.7).abs() < 0.05));
    }

    #[test]
    fn collapsed_and_torn_regions_have_no_confidence() {
        let collapsed = of(|_| Point2::new(0.5, 0.5));
        assert!(collapsed.iter().all(|c| *c < 1e-9));
        // The right half is moved away.
        let torn = of(|p| if p.x < 0.5 { p } else { Point2::new(p.x + 1.0, p.y) });
        for (p, c) in sheet(30).iter().zip(torn) {
            let from_tear = (p.x - 0.483).abs();
            assert!(if from_tear < 0.03 { c < 0.5 } else { from_tear < 0.35 || c > 0.9 }, "{p}: {c}");
        }
    }
}
