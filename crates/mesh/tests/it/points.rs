//! Laws of point clouds.

use canonform_mesh::{
    MeshError, RepairOptions, TriMesh, TriangulatedPoints, repair, shapes, triangulate_points, validate,
};
use nalgebra::{Point3, Vector3};
use surface::VertexId;

fn triangulated(points: &[Point3<f64>]) -> TriangulatedPoints {
    triangulate_points(points, &()).unwrap()
}

/// Random numbers, uniform in -0.5..0.5.
fn uniform() -> impl FnMut() -> f64 {
    let mut random = base::SplitMix(1);
    move || 0.5 * random.uniform()
}

/// Noise of this standard deviation in every coordinate. The variance of a uniform number is 1/12.
fn noise(draw: &mut impl FnMut() -> f64, deviation: f64) -> Vector3<f64> {
    Vector3::from([(); 3].map(|()| draw() * 12f64.sqrt())) * deviation
}

/// Random points of the unit sphere, each coordinate moved by noise of this standard deviation.
fn ball(n: usize, deviation: f64) -> Vec<Point3<f64>> {
    let mut draw = uniform();
    let mut points = Vec::new();
    while points.len() < n {
        let d = Vector3::from([(); 3].map(|()| 2.0 * draw()));
        if (0.1..1.0).contains(&d.norm()) {
            points.push(Point3::from(d.normalize() + noise(&mut draw, deviation)));
        }
    }
    points
}

/// Root mean square distance from the unit sphere.
fn roughness(mesh: &TriMesh) -> f64 {
    let sq = mesh.positions.iter().map(|p| (p.coords.norm() - 1.0).powi(2));
    (sq.sum::<f64>() / mesh.n_vertices() as f64).sqrt()
}

const SPHERE: f64 = 4.0 * std::f64::consts::PI;

#[test]
fn random_points_of_a_sphere_become_a_closed_sphere() {
    let found = triangulated(&ball(3000, 0.0));
    let report = validate(&found.mesh);
    assert_eq!((report.n_components, report.n_boundary_loops, report.genus), (1, 0, Some(0)), "{report:?}");
    assert_eq!((report.non_manifold_edges, report.flipped_faces), (0, 0), "{report:?}");
    assert!((found.mesh.area() / SPHERE - 1.0).abs() < 0.01, "{}", found.mesh.area());
    assert_eq!(found.report.neighbors, 0, "without noise points stay where they are");
    assert!((found.report.spacing - (SPHERE / 3000.0).sqrt()).abs() < 0.02, "{:?}", found.report);
}

#[test]
#[ignore = "slow: make test-all"]
fn noise_is_measured_and_smoothed() {
    for (n, noise) in [(4000, 0.02), (4000, 0.05), (20_000, 0.05)] {
        let points = ball(n, noise);
        let found = triangulated(&points);
        let before = roughness(&TriMesh { positions: points, faces: Vec::new() });
        let after = roughness(&found.mesh);
        assert!(after < 0.5 * before, "{n}, {noise}: {after} of {before}");
        assert!((found.mesh.area() / SPHERE - 1.0).abs() < 0.03, "{n}, {noise}: {}", found.mesh.area());
        assert!((found.report.noise / noise - 1.0).abs() < 0.4, "{n}, {noise}: {:?}", found.report);
        let report = validate(&found.mesh);
        assert!(report.n_components == 1 && report.non_manifold_edges == 0, "{n}, {noise}: {report:?}");
        assert!(found.report.replaced_points + found.report.outliers < n / 20, "{:?}", found.report);
    }
}

/// Random points of a torus, each coordinate moved by noise of this standard deviation.
fn torus(n: usize, thickness: f64, deviation: f64) -> Vec<Point3<f64>> {
    let mut draw = uniform();
    let point = |_| {
        let [(sin, cos), (y, x)] = [(); 2].map(|()| (std::f64::consts::TAU * draw()).sin_cos());
        let radius = 1.0 + thickness * cos;
        Point3::new(x * radius, y * radius, thickness * sin) + noise(&mut draw, deviation)
    };
    (0..n).map(point).collect()
}

#[test]
#[ignore = "slow: make test-all"]
fn thin_parts_keep_their_size() {
    // Six times as thick as the noise, which is as large as the spacing.
    let found = triangulated(&torus(10_000, 0.12, 0.02));
    let area = std::f64::consts::PI.powi(2) * 4.0 * 0.12;
    assert!((found.mesh.area() / area - 1.0).abs() < 0.1, "{}", found.mesh.area() / area);
    assert!((found.report.noise / 0.02 - 1.0).abs() < 0.3, "{:?}", found.report);
    let report = validate(&found.mesh);
    assert!(report.n_components == 1 && report.non_manifold_edges == 0, "{report:?}");
}

#[test]
fn boundaries_stay_open_and_sheets_stay_apart() {
    let sheet = shapes::jittered_grid(30, 20, 0.1, 0.2, 5);
    let mut above = sheet.clone();
    above.positions.iter_mut().for_each(|p| p.z += 0.5);
    let both = shapes::disjoint(&[sheet.clone(), above]);
    let found = triangulated(&both.positions);
    let report = validate(&found.mesh);
    assert_eq!((report.n_components, report.n_boundary_loops), (2, 2), "{report:?}");
    assert!((found.mesh.area() / both.area() - 1.0).abs() < 0.03, "{} of {}", found.mesh.area(), both.area());
}

#[test]
fn order_and_scale_change_nothing() {
    let points = ball(800, 0.01);
    let faces = |points: &[Point3<f64>], number: &dyn Fn(usize) -> usize| {
        let renumbered = |face: [VertexId; 3]| VertexId::sorted(face.map(|v| number(v.index()).into()));
        let mut faces: Vec<_> = triangulated(points).mesh.faces.into_iter().map(renumbered).collect();
        faces.sort_unstable();
        faces
    };
    let expected = faces(&points, &|v| v);
    let scaled: Vec<_> = points.iter().map(|p| p * 1024.0).collect();
    assert_eq!(faces(&scaled, &|v| v), expected);
    let reversed: Vec<_> = points.iter().rev().copied().collect();
    let same = faces(&reversed, &|v| points.len() - 1 - v);
    let common = same.iter().filter(|face| expected.binary_search(face).is_ok()).count();
    assert!(common as f64 > 0.98 * expected.len() as f64, "{common} of {}", expected.len());
}

#[test]
fn copies_share_a_vertex_and_outliers_are_dropped() {
    let mut points = ball(1000, 0.0);
    points.extend_from_within(..100);
    points.push(Point3::new(0.0, 0.0, 40.0));
    let repaired =
        repair(&TriMesh { positions: points, faces: Vec::new() }, &RepairOptions::default(), &()).unwrap();
    let found = repaired.report.points.unwrap();
    assert_eq!((found.n_points, found.outliers), (1101, 1));
    assert!(found.replaced_points >= 100, "{found:?}");
    for copy in 0..100 {
        let to = |point: usize| repaired.remap.to_new(VertexId::from(point));
        assert_eq!(to(1000 + copy), to(copy));
    }
    assert_eq!(repaired.report.dropped_vertices, [VertexId(1100)]);
    assert_eq!((repaired.report.input_faces, repaired.report.unreferenced_vertices), (0, 1));
    let lines = repaired.report.summary();
    assert!(lines[0].starts_with("1101 points without faces joined by "), "{lines:?}");
    assert!(lines[0].ends_with("1 far from the others left out"), "{lines:?}");
}

#[test]
fn points_without_a_surface_are_errors() {
    let of = |points: &[Point3<f64>]| triangulate_points(points, &()).unwrap_err();
    let line: Vec<_> = (0..40).map(|i| Point3::new(f64::from(i), 2.0, 3.0)).collect();
    assert!(of(&line).to_string().contains("no two of the 40 points"), "{:?}", of(&line));
    let few = [Point3::origin(); 40];
    assert!(of(&few).to_string().starts_with("1 different points without faces"));
    assert!(of(&[]).to_string().starts_with("0 different points without faces"));
    let mut bad = ball(40, 0.0);
    bad[7].x = f64::NAN;
    assert!(of(&bad).to_string().starts_with("vertex 7 has a coordinate that is not finite"));
}

#[test]
fn any_points_end_in_a_surface_or_an_error() {
    let mut draw = uniform();
    for n in [12, 13, 50, 700] {
        let solid: Vec<_> = (0..n).map(|_| Point3::from([(); 3].map(|()| draw()))).collect();
        let clumps: Vec<_> = solid.iter().map(|p| p.map(|x| (x * 4.0).round() + 1e-9 * x)).collect();
        let lattice: Vec<_> = (0..n).map(|i| Point3::new((i % 7) as f64, (i / 7) as f64, 0.0)).collect();
        for points in [solid, clumps, lattice] {
            if let Ok(found) = triangulate_points(&points, &()) {
                assert_eq!(found.mesh.n_vertices(), n);
                assert_eq!(validate(&found.mesh).non_manifold_edges, 0);
                assert!(found.mesh.positions.iter().all(|p| p.iter().all(|x| x.is_finite())));
            }
        }
    }
}

#[test]
fn a_cancelled_budget_ends_the_work() {
    let budget = base::Budget::unlimited().with_time(std::time::Duration::ZERO);
    assert!(matches!(triangulate_points(&ball(500, 0.0), &budget), Err(MeshError::Exceeded(_))));
}
