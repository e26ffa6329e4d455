use canonform_rigid::{NearestOnSurface, OnTriangle, TriangleTree};
use mesh::{TriMesh, shapes};
use nalgebra::Point3;
use surface::VertexId;

/// The nearest point of a triangle.
fn on_triangle(query: &Point3<f64>, triangle: &[Point3<f64>; 3]) -> NearestOnSurface {
    let mesh = TriMesh { positions: triangle.to_vec(), faces: vec![[0, 1, 2].map(VertexId)] };
    TriangleTree::new(&mesh).nearest(query).unwrap()
}

#[test]
fn the_nearest_point_is_the_nearest_of_all_triangles() {
    let mesh = shapes::torus(20, 12, 2.0, 0.7);
    let tree = TriangleTree::new(&mesh);
    for i in 0..200 {
        let i = f64::from(i);
        let query = Point3::new(3.0 * (1.3 * i).sin(), 3.0 * (0.7 * i).cos(), (2.1 * i).sin());
        let found = tree.nearest(&query).unwrap();
        let all = (0..mesh.n_faces()).map(|f| on_triangle(&query, &mesh.triangle(f)).sq_distance);
        assert_eq!(found.sq_distance, all.fold(f64::INFINITY, f64::min));
        assert!(((found.point - query).norm_squared() - found.sq_distance).abs() < 1e-15);
        assert!((found.normal.norm() - 1.0).abs() < 1e-12);
    }
    assert_eq!(TriangleTree::new(&TriMesh::default()).nearest(&Point3::origin()), None);
}

fn point(weights: [f64; 3], corners: [&[f64]; 3]) -> Vec<f64> {
    (0..corners[0].len()).map(|i| (0..3).map(|c| weights[c] * corners[c][i]).sum()).collect()
}

#[test]
fn the_nearest_point_of_a_triangle_is_no_farther_than_any_other_and_its_own_are_found_again() {
    let wave = |seed: f64| -> Vec<f64> { (0..7).map(|i| (seed + 1.7 * f64::from(i)).sin()).collect() };
    let grid = || (0..=20).flat_map(|i| (0..=20 - i).map(move |j| [i, j].map(|n| f64::from(n) / 20.0)));
    for case in 0..40 {
        let seed = 3.1 * f64::from(case);
        let [p, q, r, x] = [0.0, 0.9, 2.3, 4.7].map(|shift| wave(seed * (1.0 + shift) + shift));
        let corners = [&p[..], &q[..], &r[..]];
        let found = OnTriangle::nearest(&x, corners);
        assert!((found.weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        let sq = |weights: [f64; 3]| -> f64 {
            point(weights, corners).iter().zip(&x).map(|(a, b)| (a - b).powi(2)).sum()
        };
        assert!((sq(found.weights) - found.sq_distance).abs() < 1e-9);
        for [s, t] in grid() {
            let weights = [1.0 - s - t, s, t];
            assert!(sq(weights) >= found.sq_distance - 1e-9);
            let again = OnTriangle::nearest(&point(weights, corners), corners);
            assert!(again.weights.iter().zip(weights).all(|(a, b)| (a - b).abs() < 1e-9), "{again:?}");
        }
    }
    // Without area, and without length.
    let [p, q] = [wave(0.0), wave(0.9)];
    let found = OnTriangle::nearest(&q, [&p, &p, &q]);
    assert!(found.sq_distance.abs() < 1e-12 && (found.weights[2] - 1.0).abs() < 1e-12);
    assert_eq!(OnTriangle::nearest(&q, [&p, &p, &p]).weights[1..], [0.0, 0.0]);
}
