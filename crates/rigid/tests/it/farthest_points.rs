use canonform_rigid::farthest_points;
use nalgebra::Point3;

#[test]
fn each_sample_is_the_point_farthest_from_those_before_it() {
    let wave = |i: usize, f: f64| (f * i as f64).sin();
    let mut points: Vec<_> =
        (0..600).map(|i| Point3::new(wave(i, 0.7), 2.0 * wave(i, 1.3), wave(i, 2.9))).collect();
    // Ties, and points that coincide.
    points.extend((0..64).map(|i| Point3::new(f64::from(i / 16), f64::from(i % 4), 0.5)));
    points.extend_from_within(..30);
    let found = farthest_points(&points, 400);
    let mut gaps = vec![f64::INFINITY; points.len()];
    for (k, sample) in found.samples.iter().enumerate() {
        let widest = gaps.iter().copied().fold(0.0, f64::max);
        assert!(k == 0 || *sample == gaps.iter().position(|gap| *gap == widest).unwrap(), "{k}");
        for (i, gap) in gaps.iter_mut().enumerate() {
            *gap = gap.min((points[i] - points[*sample]).norm_squared());
        }
    }
    assert_eq!(found.samples.len(), 400);
    for (i, (gap, nearest)) in gaps.iter().zip(&found.nearest).enumerate() {
        assert_eq!((points[i] - points[found.samples[*nearest]]).norm_squared(), *gap);
    }
    assert_eq!(farthest_points(&points, 10_000).samples.len(), points.len() - 30 - 48);
    assert!(farthest_points(&[], 5).samples.is_empty());
}
