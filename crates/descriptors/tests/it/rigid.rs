//! Laws of the signature of surfaces that do not bend.

use canonform_descriptors::{Signature, SignatureKind, rigid_signature};
use mesh::{TriMesh, shapes};
use nalgebra::{Point3, Rotation3, Vector3};

/// A block with a slanted top: planes of six directions, and no symmetry.
fn block() -> TriMesh {
    testkit::moved(&shapes::cube(2), |p| {
        Point3::new(1.7 * p.x, p.y + 0.3 * p.x, p.z * (1.0 + 0.4 * p.x + 0.2 * p.y))
    })
}

#[test]
fn powers_of_normals_are_legendre_polynomials_of_their_angles() {
    let mesh = block();
    let vectors: Vec<Vector3<f64>> = (0..mesh.n_faces()).map(|f| mesh.area_vector(f)).collect();
    let total: f64 = vectors.iter().map(|v| v.norm()).sum();
    let legendre = |l: usize, x: f64| match l {
        2 => 0.5 * (3.0 * x * x - 1.0),
        4 => (35.0 * x.powi(4) - 30.0 * x * x + 3.0) / 8.0,
        _ => (231.0 * x.powi(6) - 315.0 * x.powi(4) + 105.0 * x * x - 5.0) / 16.0,
    };
    let found = rigid_signature(&mesh).unwrap().values;
    for l in [2, 4, 6] {
        let pairs = vectors.iter().flat_map(|v| vectors.iter().map(move |w| (v, w)));
        let expected: f64 = pairs
            .map(|(v, w)| v.norm() * w.norm() * legendre(l, v.normalize().dot(&w.normalize())))
            .sum::<f64>()
            / (total * total);
        // The powers of degrees 2 to 8 follow the first twenty values, divided by ten.
        let power = 10.0 * found[20 + l - 2];
        assert!((power - expected).abs() < 1e-12, "degree {l}: {power} {expected}");
    }
}

#[test]
fn values_of_a_cube_are_known() {
    let Signature { values, .. } = rigid_signature(&shapes::cube(0)).unwrap();
    assert_eq!(values.len(), SignatureKind::Rigid.n_values());
    let side = 1.0 / 6.0f64.sqrt();
    assert!((values[0] - side).abs() < 1e-12);
    // The square of a coordinate is (side / 2)² on two faces and a third of it on four.
    let spread = side / 2.0 * ((2.0 + 4.0 / 3.0) / 6.0f64).sqrt();
    assert!(values[1..4].iter().all(|x| (x - spread).abs() < 1e-12), "{values:?}");
    // Of the distances between corners, the shortest are sides and the longest diagonals, divided by four.
    let expected = [side / 4.0, side / 4.0 * 3f64.sqrt()];
    assert!([4, 19].iter().zip(expected).all(|(i, x)| (values[*i] - x).abs() < 1e-12), "{values:?}");
}

#[test]
fn motions_mirror_images_and_scale_change_nothing_and_another_shape_does() {
    let mesh = block();
    let distance = |other: &TriMesh| {
        let [a, b] = [&mesh, other].map(|mesh| rigid_signature(mesh).unwrap());
        a.distance(&b)
    };
    let turn = Rotation3::from_euler_angles(0.3, -0.7, 1.9);
    let moved = |flip: f64| testkit::moved(&mesh, |p| turn * Point3::new(flip * p.x, p.y, p.z) * 25.4);
    for flip in [1.0, -1.0] {
        assert!(distance(&moved(flip)) < 1e-3, "{flip}");
    }
    assert!(distance(&testkit::moved(&mesh, |p| Point3::new(p.x, p.y, p.z + 0.5 * p.x))) > 0.01);
    assert_eq!(rigid_signature(&shapes::lopsided_torus()), None, "it may bend");
}
