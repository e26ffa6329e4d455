use canonform_rigid::Similarity;
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

#[test]
fn fits_recover_a_map_and_its_inverse_undoes_it() {
    let turn = Rotation3::from_euler_angles(0.3, -1.1, 2.0).into_inner();
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    for (rotation, scale) in [(turn, 1.0), (turn * mirror, 1.0), (turn, 25.4), (turn * mirror, 0.1)] {
        let map = Similarity {
            translation: Vector3::new(1.0, 2.0, -3.0),
            scale,
            ..Similarity::about_origin(rotation)
        };
        let points: Vec<_> = (0..20)
            .map(f64::from)
            .map(|i| Point3::new((i * 1.3).sin(), (i * 0.7).cos() * 2.0, (i * i * 0.1).sin() * 0.5))
            .collect();
        let pairs: Vec<_> = points.iter().map(|p| (*p, map.apply(p))).collect();
        let fit = Similarity::fit_scaled(&pairs, map.reflected).unwrap();
        let identity = fit.inverse().after(&map);
        for (found, wanted) in [(fit, map), (identity, Similarity::identity())] {
            assert!((found.rotation - wanted.rotation).norm() < 1e-13);
            assert!((found.translation - wanted.translation).norm() < 1e-13 * scale.max(1.0 / scale));
            assert!((found.scale / wanted.scale - 1.0).abs() < 1e-13);
            assert_eq!(found.reflected, wanted.reflected);
        }
        let motion = Similarity::fit_motion(&pairs, map.reflected).unwrap();
        assert!(motion.scale == 1.0 && (motion.rotation - rotation).norm() < 1e-13);
        let wrong = Similarity::fit_motion(&pairs, !map.reflected).unwrap();
        assert!((wrong.rotation.determinant() + rotation.determinant()).abs() < 1e-12);
    }
    assert_eq!(Similarity::fit_motion(&[], false), None);
    assert_eq!(Similarity::fit_scaled(&[(Point3::origin(), Point3::origin()); 2], false), None);
}
