//! Laws of noise.

use canonform_mesh::{TriMesh, denoise, is_noisy, shapes};
use nalgebra::Vector3;

/// A torus whose vertices are moved in all directions by about `amount`.
fn noisy(amount: f64) -> TriMesh {
    let mut torus = shapes::torus(60, 30, 2.0, 0.7);
    let mut random = base::SplitMix(1);
    for p in &mut torus.positions {
        p.coords += Vector3::from([(); 3].map(|()| random.uniform())) * 1.75 * amount;
    }
    torus
}

/// Mean distance from the surface of the torus.
fn error(mesh: &TriMesh) -> f64 {
    let from = |p: &nalgebra::Point3<f64>| (((p.x.hypot(p.y) - 2.0).hypot(p.z)) - 0.7).abs();
    mesh.positions.iter().map(from).sum::<f64>() / mesh.n_vertices() as f64
}

#[test]
fn noise_is_smoothed_away_and_the_volume_stays() {
    let (clean, rough) = (shapes::torus(60, 30, 2.0, 0.7), noisy(0.05));
    assert!(!is_noisy(&clean) && is_noisy(&rough));
    let smooth = denoise(&rough, &rough.topology()).unwrap();
    assert_eq!(smooth.faces, rough.faces);
    assert!(error(&smooth) < 0.5 * error(&rough), "{} of {}", error(&smooth), error(&rough));
    let area = [&clean, &rough, &smooth].map(TriMesh::area);
    assert!(area[1] > 1.1 * area[0] && (area[2] / area[0] - 1.0).abs() < 0.03, "{area:?}");
    assert!(denoise(&smooth, &smooth.topology()).is_none());
}

#[test]
fn clean_meshes_are_left_alone() {
    let mut tilted = shapes::grid(8, 8, 1.0);
    let tilt = nalgebra::Rotation3::from_euler_angles(0.3, 0.4, 0.5);
    tilted.positions.iter_mut().for_each(|p| *p = tilt * *p);
    let cube = shapes::cube(3);
    let torus = shapes::torus(20, 12, 2.0, 0.7);
    let subdivided = shapes::subdivide(&torus);
    let mut turned = torus.clone();
    turned.faces.iter_mut().step_by(3).for_each(|face| face.swap(0, 1));
    let empty = TriMesh { positions: Vec::new(), faces: Vec::new() };
    for mesh in [tilted, cube, torus, subdivided, turned, shapes::tetrahedron(0), empty] {
        assert!(!is_noisy(&mesh) && denoise(&mesh, &mesh.topology()).is_none());
    }
}

#[test]
fn boundaries_stay_where_they_are() {
    let mut sheet = shapes::jittered_grid(30, 30, 1.0, 0.0, 1);
    let before = sheet.clone();
    for (i, p) in sheet.positions.iter_mut().enumerate() {
        p.z += 0.2 * (12.9 * i as f64).sin();
    }
    let smooth = denoise(&sheet, &sheet.topology()).unwrap();
    let [old, new] = [&before, &smooth].map(|mesh| mesh.bounds().unwrap());
    assert!((old[0] - new[0]).xy().amax() < 0.3 && (old[1] - new[1]).xy().amax() < 0.3);
    let areas = [&before, &sheet, &smooth].map(TriMesh::area);
    assert!(areas[1] > 1.03 * areas[0] && (areas[2] / areas[0] - 1.0).abs() < 0.02, "{areas:?}");
}

#[test]
fn the_unit_of_length_does_not_matter() {
    let rough = noisy(0.05);
    let smooth = denoise(&rough, &rough.topology()).unwrap();
    for exponent in [-400, 400] {
        let factor = 2_f64.powi(exponent);
        let scaled = testkit::moved(&rough, |p| p * factor);
        let found = denoise(&scaled, &scaled.topology()).unwrap();
        assert!(found.positions.iter().zip(&smooth.positions).all(|(a, b)| *a == b * factor));
    }
}
