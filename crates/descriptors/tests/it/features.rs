//! Laws of features that forms lose.

use canonform_descriptors::{CanonicalForm, DescriptorError};
use mesh::{TriMesh, shapes};
use nalgebra::{Matrix3, Point3, Rotation3, Vector3};

/// A surface without symmetry.
fn body() -> TriMesh {
    shapes::lopsided_torus()
}

fn form(points: Vec<Point3<f64>>, mesh: &TriMesh) -> CanonicalForm {
    let form = CanonicalForm::from_points(points, mesh.vertex_areas()).unwrap();
    CanonicalForm::from_parts(form.points().to_vec(), form.weights().to_vec(), Some(mesh.area())).unwrap()
}

/// The form of a mesh whose thickness is lost.
fn flattened(mesh: &TriMesh) -> CanonicalForm {
    form(mesh.positions.iter().map(|p| Point3::new(p.x, p.y, 0.2 * p.z)).collect(), mesh)
}

fn farthest(a: &CanonicalForm, b: &[Point3<f64>]) -> f64 {
    a.points().iter().zip(b).map(|(x, y)| (x - y).norm()).fold(0.0, f64::max)
}

#[test]
fn a_surface_bent_towards_itself_stays() {
    let mesh = body();
    let own = form(mesh.positions.clone(), &mesh);
    let points: Vec<_> = mesh.positions.iter().map(|p| p * 1e-3).collect();
    // Without a unit, a form is scaled to the surface.
    let unitless = CanonicalForm::from_points(points, mesh.vertex_areas()).unwrap();
    for form in [&own, &unitless] {
        let bent = form.with_features(&mesh, &()).unwrap();
        assert!(farthest(&bent, own.points()) < 1e-9);
        assert!((bent.area().unwrap() / mesh.area() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn what_moves_scales_or_mirrors_the_surface_or_the_form_moves_scales_or_mirrors_the_result() {
    let mesh = body();
    let own = flattened(&mesh);
    let bent = own.with_features(&mesh, &()).unwrap();
    let turn = Rotation3::from_euler_angles(0.4, 1.0, -2.0).into_inner();
    let mirror = Matrix3::from_diagonal(&Vector3::new(1.0, 1.0, -1.0));
    let assert_moved = |form: &CanonicalForm, mesh: &TriMesh, is_reflected: bool, [scale, most]: [f64; 2]| {
        let again = form.with_features(mesh, &()).unwrap();
        let pairs: Vec<_> =
            bent.points().iter().map(|p| p * scale).zip(again.points().iter().copied()).collect();
        let fit = rigid::Similarity::fit_motion(&pairs, is_reflected).unwrap();
        let error = pairs.iter().map(|(x, y)| (fit.apply(x) - y).norm()).fold(0.0, f64::max);
        assert!(error < most * mesh.size(), "{error}");
    };
    // The surface is not mirrored with its form.
    for motion in [turn, turn * mirror] {
        let points = own.points().iter().map(|p| motion * p).collect();
        assert_moved(&form(points, &mesh), &mesh, false, [1.0, 1e-6]);
    }
    let mut mirrored = testkit::moved(&mesh, |p| Point3::new(-p.x, p.y, p.z));
    mirrored.faces.iter_mut().for_each(|face| face.swap(0, 1));
    assert_moved(&own, &mirrored, true, [1.0, 1e-6]);
    let large = testkit::moved(&mesh, |p| p * 64.0);
    assert_moved(&flattened(&large), &large, false, [64.0, 1e-9]);
}

#[test]
fn features_that_a_form_has_lost_come_back() {
    let mesh = body();
    let own = flattened(&mesh);
    let bent = own.with_features(&mesh, &()).unwrap();
    let stretch = |points: &[Point3<f64>]| {
        let sides = mesh.faces.iter().flat_map(|f| [(f[0], f[1]), (f[1], f[2]), (f[2], f[0])]);
        let change = |(a, b): (surface::VertexId, surface::VertexId)| {
            let length = |points: &[Point3<f64>]| (points[a.index()] - points[b.index()]).norm();
            (length(points) / length(&mesh.positions)).ln().abs()
        };
        sides.map(change).sum::<f64>() / (3 * mesh.n_faces()) as f64
    };
    assert!(stretch(bent.points()) < 0.4 * stretch(own.points()), "{}", stretch(bent.points()));
}

#[test]
fn what_does_not_fit_is_refused() {
    let mesh = body();
    let other = flattened(&shapes::icosphere(2));
    assert!(matches!(other.with_features(&mesh, &()), Err(DescriptorError::SizeMismatch { .. })));
    let mut point = mesh.clone();
    point.positions.iter_mut().for_each(|p| *p = Point3::origin());
    assert!(matches!(flattened(&mesh).with_features(&point, &()), Err(DescriptorError::NoExtent { .. })));
}
