use canonform_rigid::{PointSet, Reflections, align_points};
use nalgebra::{Point3, Rotation3, Vector3};

/// A figure of three arms without symmetry.
fn figure(n: usize, bend: f64) -> Vec<Point3<f64>> {
    (0..n)
        .map(|i| {
            let t = i as f64 / n as f64;
            let (arm, s) = ((t * 3.0).floor(), (t * 3.0).fract());
            match arm as usize {
                0 => Point3::new(6.0 * s, bend * s * s, 0.3 * (9.0 * s).sin()),
                1 => Point3::new(-2.0 * s, 3.0 * s, 0.2 * s),
                _ => Point3::new(0.5 * s, -1.5 * s * s, 1.6 * s),
            }
        })
        .collect()
}

/// About their centroid.
fn centered(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mean = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len() as f64;
    points.iter().map(|p| p - mean).collect()
}

fn prepared(points: &[Point3<f64>]) -> PointSet {
    PointSet::new(&centered(points), &vec![1.0 / points.len() as f64; points.len()]).unwrap()
}

fn turned(points: &[Point3<f64>], mirror: f64) -> Vec<Point3<f64>> {
    let turn = Rotation3::from_euler_angles(1.0, 0.4, -2.0);
    points.iter().map(|p| turn * Point3::new(p.x, p.y, mirror * p.z) + Vector3::new(3.0, 1.0, 0.0)).collect()
}

#[test]
fn a_moved_set_has_distance_zero_and_its_motion_is_found() {
    let points = figure(600, 1.0);
    for mirror in [1.0, -1.0] {
        let found = align_points(&prepared(&points), &prepared(&turned(&points, mirror)), Reflections::Allow);
        assert_eq!(found.map.reflected, mirror < 0.0);
        let (a, b) = (centered(&points), centered(&turned(&points, mirror)));
        let gap = a.iter().zip(&b).map(|(p, q)| (found.map.apply(p) - q).norm());
        assert!(gap.fold(0.0, f64::max) < 1e-9);
    }
}

#[test]
fn a_mirror_image_differs_if_reflections_are_forbidden() {
    let points = figure(600, 1.0);
    let by = |reflections, other: &PointSet| align_points(&prepared(&points), other, reflections);
    // Whatever the handedness of the principal axes.
    for axis in 0..3 {
        let mut signs = Vector3::repeat(1.0);
        signs[axis] = -1.0;
        let mirrored: Vec<_> = points.iter().map(|p| Point3::from(p.coords.component_mul(&signs))).collect();
        let found = by(Reflections::Forbid, &prepared(&mirrored));
        assert!(found.gap.rms > 0.05 && !found.map.reflected, "{axis}");
        let found = by(Reflections::Require, &prepared(&mirrored));
        assert!(found.gap.rms < 1e-9 && found.map.reflected, "{axis}");
    }
    let same = by(Reflections::Require, &prepared(&points));
    assert!(same.gap.rms > 0.05 && same.map.reflected);
}

#[test]
fn the_distance_is_symmetric_and_grows_with_the_difference() {
    let base = prepared(&figure(600, 1.0));
    let mut last = 0.0;
    for bend in [1.5, 2.5, 4.0] {
        let other = prepared(&figure(500, bend));
        let there = align_points(&base, &other, Reflections::Allow);
        let back = align_points(&other, &base, Reflections::Allow);
        assert!(
            (there.gap.rms - back.gap.rms).abs() < 0.02 * there.gap.rms,
            "{} {}",
            there.gap.rms,
            back.gap.rms
        );
        assert!(there.gap.rms > last);
        last = there.gap.rms;
    }
}

#[test]
fn near_equal_axes_are_exchanged() {
    // Two crosses whose longer arm is not the same one: the heads at the ends of the arms only meet if axes
    // are exchanged.
    let cross = |along: f64, across: f64| -> Vec<Point3<f64>> {
        (0..300)
            .flat_map(|i| {
                let s = f64::from(i) / 150.0 - 1.0;
                let head = if s > 0.9 { 0.8 } else { 0.0 };
                [Point3::new(along * s, 0.0, head), Point3::new(0.0, across * s, 0.0)]
            })
            .collect()
    };
    let distance = |across: f64| {
        align_points(&prepared(&cross(4.0, across)), &prepared(&cross(across, 4.0)), Reflections::Allow)
            .gap
            .rms
    };
    assert!(distance(4.4) < 0.7 * distance(5.0), "spreads that differ by 10 % and by 25 %");
}
