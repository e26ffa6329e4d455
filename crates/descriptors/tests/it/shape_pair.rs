//! Laws of pairs of shapes.

use canonform_descriptors::{CanonicalForm, PreparedShape, ShapePair};
use nalgebra::Point3;
use rigid::Reflections;

/// A spiral without symmetry; `turn` is -1 for its mirror image.
fn spiral(turns: f64, turn: f64, size: f64) -> PreparedShape {
    let points: Vec<_> = (0..400)
        .map(|i| f64::from(i) / 400.0)
        .map(|s| Point3::new(3.0 * s, s * (turns * s).cos(), turn * 0.7 * s * (turns * s).sin()) * size)
        .collect();
    let (area, weights) = (Some(4.0 * size * size), vec![1.0 / 400.0; 400]);
    let form = CanonicalForm::from_points(points, weights.clone()).unwrap();
    let form = CanonicalForm::from_parts(form.points().to_vec(), weights, area).unwrap();
    PreparedShape::new(vec![turns as f32], Vec::new(), &form, area).unwrap()
}

#[test]
fn the_better_handed_alignment_is_the_best_one() {
    let (left, right) = (spiral(4.0, 1.0, 1.0), spiral(4.0, -1.0, 3.0));
    let pair = ShapePair::new([&left, &right]);
    let best = pair.best();
    assert!(best.gap.rms < 1e-6 && best.map.reflected && (pair.scale() - 3.0).abs() < 1e-12);
    assert_eq!(pair.best_with(Reflections::Require), best);
    let proper = pair.best_with(Reflections::Forbid);
    assert!(proper.gap.rms > 100.0 * best.gap.rms && !proper.map.reflected);
    assert!(pair.align_raw().unwrap().gap.rms > 0.1, "of different size");
    assert_eq!(pair.distance().fused, 0.0);
}
