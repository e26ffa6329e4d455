use canonform_rigid::{NearestOnSurface, TriangleTree};
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

#[test]
fn the_nearest_point_of_a_triangle_is_no_farther_than_points_inside() {
    let triangle = [[0.0, 0.0, 0.0], [2.0, 0.1, 0.0], [0.5, 1.0, 0.3]].map(Point3::from);
    for i in 0..300 {
        let i = f64::from(i);
        let query = Point3::new(3.0 * (1.1 * i).sin(), 2.0 * (0.6 * i).cos(), (1.7 * i).sin());
        let found = on_triangle(&query, &triangle).sq_distance.sqrt();
        for (u, v) in (0..=20).flat_map(|u| (0..=20 - u).map(move |v| (f64::from(u), f64::from(v)))) {
            let [a, b, c] = triangle;
            let inside = a + (b - a) * (u / 20.0) + (c - a) * (v / 20.0);
            assert!(found <= (inside - query).norm() + 1e-12);
        }
    }
}
