//! Laws of the metric.

use canonform_descriptors::{Boundary, ShapeDistance, ShapeMetric, Signature, SignatureKind};

#[test]
fn weights_sum_to_one() {
    let total: f64 = SignatureKind::INTRINSIC.into_iter().map(ShapeMetric::weight).sum();
    assert!((total - 1.0).abs() < 1e-9);
    assert!(SignatureKind::ALL.into_iter().all(|kind| ShapeMetric::unit(kind) > 0.0));
}

#[test]
fn fused_vectors_add_weighted_signatures_that_may_bend_and_the_size() {
    let fused = |value: f64, area: Option<f64>| {
        let of = |kind: SignatureKind| Signature { kind, values: vec![value; kind.n_values()] };
        ShapeMetric::fuse(&[SignatureKind::Rigid, SignatureKind::ShapeDna].map(of), area)
    };
    let [weight, unit] = [ShapeMetric::weight, ShapeMetric::unit].map(|of| of(SignatureKind::ShapeDna));
    let found = ShapeMetric::fused(&fused(1.0, None), &fused(1.5, None));
    assert!((found / (0.5 * (20.0 * weight).sqrt() / unit) - 1.0).abs() < 1e-5);
    // Lengths differ by two units, areas by four.
    let found = ShapeMetric::fused(&fused(1.0, Some(1.0)), &fused(1.0, Some(1.05f64.powi(4))));
    assert!((found - 2.0).abs() < 1e-6);
}

#[test]
fn values_beyond_four_deviations_of_their_kind_count_linearly() {
    let mut start = 0;
    for kind in SignatureKind::INTRINSIC.into_iter().filter(|kind| ShapeMetric::weight(*kind) > 0.0) {
        let weight = ShapeMetric::weight(kind);
        let limit = 4.0 * (weight / kind.n_values() as f64).sqrt();
        let at = |change: f64| {
            let mut vector = vec![0.0f32; ShapeMetric::FUSED_LENGTH];
            let other = vector.clone();
            vector[start] = change as f32;
            ShapeMetric::robust(&vector, &other)
        };
        assert_eq!(ShapeMetric::limits()[start], limit as f32);
        assert!((at(0.99 * limit) / (0.99 * limit) - 1.0).abs() < 1e-6, "small changes count fully");
        for times in [2.0, 5.0, 20.0] {
            let expected = limit * (2.0 * times - 1.0f64).sqrt();
            assert!((at(times * limit) / expected - 1.0).abs() < 1e-6, "{times}");
        }
        start += kind.n_values();
    }
    let sized = |size: f32| [vec![0.0; ShapeMetric::FUSED_LENGTH], vec![size]].concat();
    assert!((ShapeMetric::robust(&sized(0.0), &sized(7.0)) - 7.0).abs() < 1e-12, "size is not limited");
}

#[test]
fn space_only_separates_two_surfaces_that_do_not_bend() {
    let rigid = |change: f32| vec![0.3 + change; SignatureKind::Rigid.n_values()];
    assert_eq!(ShapeMetric::rigid(&rigid(0.0), &rigid(0.0)), 0.0);
    assert_eq!((ShapeMetric::rigid(&rigid(0.0), &[]), ShapeMetric::rigid(&[], &[])), (0.0, 0.0));
    // Copies are a small part of the unit of two poses apart, and no parts are farther than two shapes.
    let copies = (0.0011f64.powi(2) / 27.0).sqrt() as f32;
    assert!((0.02..0.1).contains(&ShapeMetric::rigid(&rigid(0.0), &rigid(copies))));
    assert_eq!(ShapeMetric::rigid(&rigid(0.0), &rigid(9.0)), ShapeMetric::SAME_SHAPE.at);
}

#[test]
fn answers_follow_each_other_as_the_distance_grows() {
    let at = |combined| ShapeDistance { fused: combined, combined };
    let mut last = at(0.0);
    // Not even distance 0 proves one shape.
    assert!(last.is_same_shape() && last.same_shape() < Boundary::CERTAIN && last.same_class() > 0.99);
    for i in 1..4000 {
        let combined = f64::from(i) * 0.005;
        let next = at(combined);
        assert!(next.same_shape() <= last.same_shape() && next.same_class() <= last.same_class());
        assert!(next.same_shape() <= next.same_class());
        assert_eq!(combined < ShapeMetric::SAME_CLASS.at, next.same_class() > 0.5);
        assert!(!next.is_same_shape() || next.same_class() > 0.5);
        assert!(next.same_class() < 0.5 || !next.is_different());
        last = next;
    }
    assert!(last.is_different());
}

#[test]
fn a_combined_distance_has_its_parts_and_its_limit_is_that_of_the_form() {
    let at = ShapeMetric::SAME_CLASS.at;
    for robust in [0.0, 0.3 * at, 0.85 * at] {
        let limit = ShapeMetric::form_limit(robust, at);
        let combined = ShapeMetric::combined(robust, limit);
        assert!((combined / at - 1.0).abs() < 1e-6 && combined > at);
        assert!((ShapeMetric::same_below(combined, limit) - limit).abs() < 1e-6);
    }
    assert_eq!(ShapeMetric::same_below(1.15 * at, 0.0), 0.0);
    assert_eq!(ShapeMetric::same_below(0.1, 9.0), ShapeMetric::form_limit(0.0, at));
}
