use canonform_rigid::{RigidSurface, align_surfaces};
use mesh::{TriMesh, shapes};
use nalgebra::{Point3, Rotation3, Vector3};

fn surface(mesh: &TriMesh) -> RigidSurface {
    RigidSurface::new(mesh.clone()).unwrap()
}

fn changed(mesh: &TriMesh, scale: f64, flip: f64) -> TriMesh {
    let turn = Rotation3::from_euler_angles(0.3, 2.0, -1.0);
    let to = |p: &Point3<f64>| turn * Point3::new(flip * p.x, p.y, p.z) * scale + Vector3::new(5.0, 2.0, 3.0);
    TriMesh { positions: mesh.positions.iter().map(to).collect(), faces: mesh.faces.clone() }
}

#[test]
fn subdivided_and_moved_surfaces_coincide() {
    let mesh = shapes::lopsided_torus();
    for (flip, mirrored) in [(1.0, false), (-1.0, true)] {
        let other = changed(&shapes::subdivide(&mesh), 25.4, flip);
        let found = align_surfaces(&surface(&mesh), &surface(&other)).unwrap();
        assert!(found.gap.max < 1e-4, "{found:?}");
        assert_eq!(found.map.reflected, mirrored);
        assert!((found.map.scale - 1.0).abs() < 1e-4, "{}", found.map.scale);
    }
}

#[test]
fn bodies_with_equal_axes_are_aligned() {
    // A cube, and a ring with three knobs.
    let mut ring = shapes::torus(60, 20, 2.0, 0.5);
    for p in &mut ring.positions {
        let angle = p.y.atan2(p.x);
        p.coords *= 1.0 + 0.3 * ((3.0 * angle).cos() - 1.0).exp();
    }
    for mesh in [shapes::cube(5), ring] {
        let other = changed(&shapes::subdivide(&mesh), 1.0, 1.0);
        let found = align_surfaces(&surface(&mesh), &surface(&other)).unwrap();
        assert!(found.gap.rms < 1e-3, "{found:?}");
        assert!(!found.map.reflected, "its own mirror image");
    }
}

#[test]
fn other_surfaces_are_apart() {
    let mesh = shapes::lopsided_torus();
    let mut bent = mesh.clone();
    for p in &mut bent.positions {
        p.x += 0.25 * p.y * p.y;
    }
    let found = align_surfaces(&surface(&mesh), &surface(&bent)).unwrap();
    assert!(found.gap.rms > 0.01, "{found:?}");
    assert_eq!(align_surfaces(&surface(&mesh), &surface(&shapes::icosphere(3))), None);
}

#[test]
fn surfaces_are_centered_at_unit_area() {
    let mut torus = shapes::torus(40, 20, 2.0, 0.7);
    torus.positions.iter_mut().for_each(|p| *p = *p * 25.4 + Vector3::new(300.0, -7.0, 20.0));
    let torus = surface(&torus);
    assert!((torus.mesh().area() - 1.0).abs() < 1e-12);
    assert!((torus.center - Point3::new(300.0, -7.0, 20.0)).norm() < 1e-9);
    assert!(torus.mesh().moments().0.norm() < 1e-12);
    assert!(RigidSurface::new(TriMesh::default()).is_none());
}
