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

fn turned(points: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let turn = Rotation3::from_euler_angles(1.0, 0.4, -2.0);
    points.iter().map(|p| turn * p + Vector3::new(3.0, 1.0, 0.0)).collect()
}

#[test]
fn the_motion_of_a_moved_set_is_found_and_its_mirror_image_differs_without_reflections() {
    let points = figure(600, 1.0);
    let base = prepared(&points);
    // Whatever the handedness of the principal axes.
    for signs in [[1.0; 3], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0]] {
        let is_mirrored = signs.contains(&-1.0);
        let mirrored: Vec<_> =
            points.iter().map(|p| Point3::from(p.coords.component_mul(&Vector3::from(signs)))).collect();
        let other = turned(&mirrored);
        let found = align_points(&base, &prepared(&other), Reflections::Allow);
        assert_eq!(found.map.reflected, is_mirrored, "{signs:?}");
        let (a, b) = (centered(&points), centered(&other));
        let gap = a.iter().zip(&b).map(|(p, q)| (found.map.apply(p) - q).norm());
        assert!(gap.fold(0.0, f64::max) < 1e-9, "{signs:?}");
        let [right, wrong] = match is_mirrored {
            true => [Reflections::Require, Reflections::Forbid],
            false => [Reflections::Forbid, Reflections::Require],
        };
        let [right, wrong] = [right, wrong].map(|by| align_points(&base, &prepared(&other), by));
        assert!(right.gap.rms < 1e-9 && right.map.reflected == is_mirrored, "{signs:?}");
        assert!(wrong.gap.rms > 0.05 && wrong.map.reflected != is_mirrored, "{signs:?}");
    }
}

#[test]
fn the_distance_is_symmetric_and_grows_with_the_difference() {
    let base = prepared(&figure(600, 1.0));
    let mut last = 0.0;
    for bend in [1.5, 2.5, 4.0] {
        let other = prepared(&figure(500, bend));
        let [there, back] =
            [(&base, &other), (&other, &base)].map(|(a, b)| align_points(a, b, Reflections::Allow).gap.rms);
        assert!((there - back).abs() < 0.02 * there && there > last, "{there} {back}");
        last = there;
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
        let crosses = [cross(4.0, across), cross(across, 4.0)].map(|points| prepared(&points));
        align_points(&crosses[0], &crosses[1], Reflections::Allow).gap.rms
    };
    assert!(distance(4.4) < 0.7 * distance(5.0), "spreads that differ by 10 % and by 25 %");
}
