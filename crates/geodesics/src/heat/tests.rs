use mesh::TriMesh;
use mesh::shapes::{cylinder, disjoint, grid, icosphere, jittered_grid, sheared_grid};
use surface::{FaceId, Link};

use super::*;

fn heat(mesh: &IntrinsicMesh) -> HeatMethod {
    HeatMethod::new(mesh, HeatOptions::default(), &()).unwrap()
}

/// Mean of `|found - expected| / expected` over all but the source.
fn mean_error(found: &[f64], expected: impl Fn(usize) -> f64) -> f64 {
    let errors = found.iter().enumerate().map(|(v, d)| (d, expected(v))).filter(|(_, e)| *e > 0.0);
    errors.map(|(d, e)| (d - e).abs() / e).sum::<f64>() / (found.len() - 1) as f64
}

fn great_circle(mesh: &TriMesh, source: usize) -> impl Fn(usize) -> f64 {
    let p = mesh.positions.clone();
    move |v| p[source].coords.dot(&p[v].coords).clamp(-1.0, 1.0).acos()
}

fn straight(mesh: &TriMesh, source: usize) -> impl Fn(usize) -> f64 {
    let p = mesh.positions.clone();
    move |v| (p[source] - p[v]).norm()
}

#[test]
fn errors_on_a_plane_and_on_a_sphere_fall_with_edge_length() {
    let mut previous = f64::INFINITY;
    for n in [11, 21, 41, 81] {
        let mesh = jittered_grid(n, n, 1.0 / (n - 1) as f64, 0.24, 7);
        let source = mesh.n_vertices() / 2;
        let found = heat(&mesh.intrinsic()).distances(VertexId::from(source)).unwrap();
        let error = mean_error(&found, straight(&mesh, source));
        assert!(error < previous / 1.25, "{n}: {error} after {previous}");
        previous = error;
    }
    assert!(previous < 0.009, "{previous}");
    for (level, bound) in [(2, 0.008), (3, 0.005), (4, 0.0025)] {
        let mesh = icosphere(level);
        let error =
            mean_error(&heat(&mesh.intrinsic()).distances(VertexId(0)).unwrap(), great_circle(&mesh, 0));
        assert!(error < bound, "{level}: {error}");
    }
}

#[test]
fn a_time_of_first_order_makes_the_error_vanish() {
    let mut previous = f64::INFINITY;
    for (level, n) in [(3, 16.0), (4, 32.0), (5, 64.0)] {
        let mesh = icosphere(level);
        let method = HeatMethod::new(&mesh.intrinsic(), HeatOptions { time: n / 16.0 }, &()).unwrap();
        let error = mean_error(&method.distances(VertexId(0)).unwrap(), great_circle(&mesh, 0));
        assert!(error < previous / 1.5, "{level}: {error} after {previous}");
        previous = error;
    }
    assert!(previous < 0.0015, "{previous}");
}

#[test]
fn obtuse_triangles_do_not_increase_the_error() {
    // All triangles obtuse, up to 176 degrees; the sheet stays convex, so distances are straight.
    for shear in [1.0, 3.0, 15.0] {
        let mesh = sheared_grid(31, 31, 1.0, shear);
        let surface = mesh.intrinsic();
        let method = heat(&surface);
        let inside = |f: usize| {
            let corners = mesh.faces[f].map(|v| mesh.positions[v.index()].coords);
            let from = corners[0] * 0.2 + corners[1] * 0.5 + corners[2] * 0.3;
            (SurfacePoint::Face { face: FaceId::from(f), barycentric: [0.2, 0.5, 0.3] }, from)
        };
        let vertex = (SurfacePoint::Vertex(VertexId(480)), mesh.positions[480].coords);
        for (point, from) in [vertex, inside(15 * 60 + 30), inside(9 * 60 + 25)] {
            let source = Source::new(&surface, point).unwrap();
            let found = crate::tests::distances_from(&method, &[source], f64::INFINITY);
            let error = mean_error(&found, |v| (from - mesh.positions[v].coords).norm());
            assert!(error < 0.03, "{shear} from {point}: {error}");
        }
    }
}

/// Two spheres of 642 vertices joined by a link between their first vertices.
fn dumbbell(length: f64) -> IntrinsicMesh {
    let link = Link { ends: [VertexId(0), VertexId(642)], length };
    disjoint(&[icosphere(3), icosphere(3)]).intrinsic().with_links(vec![link])
}

#[test]
fn a_bridge_adds_its_length() {
    let alone = heat(&icosphere(3).intrinsic());
    for length in [0.0, 0.05, 1.0, 300.0] {
        let found = heat(&dumbbell(length)).distances(VertexId(100)).unwrap();
        let near = alone.distances(VertexId(100)).unwrap();
        let far = alone.distances(VertexId(0)).unwrap();
        // As good as without it on either side; the shifts at both ends are of the order of an edge.
        assert!(mean_error(&found[..642], |v| near[v]) < 0.02, "{length}");
        let beyond = |v: usize| near[0] + length + far[v];
        assert!(mean_error(&found[642..], beyond) < 0.05, "{length}");
        // Short times end where heat would no longer arrive.
        let brief = HeatMethod::new(&dumbbell(length), HeatOptions { time: 1e-12 }, &()).unwrap();
        let found = brief.distances(VertexId(100)).unwrap();
        assert!(mean_error(&found[642..], beyond) < 0.4, "{length}");
    }
}

#[test]
fn a_link_within_a_component_is_used_only_if_it_is_short() {
    // From one end of a long strip to the other.
    let strip = grid(101, 6, 0.1).intrinsic();
    let (left, right) = (VertexId(303), VertexId(403));
    let with = |length: f64| {
        let link = Link { ends: [left, right], length };
        heat(&strip.clone().with_links(vec![link])).distances(left).unwrap()
    };
    let without = heat(&strip).distances(left).unwrap();
    let short = with(0.5);
    assert!((short[right.index()] - 0.5).abs() < 0.1, "{}", short[right.index()]);
    assert!((short[right.index() - 10] - 1.5).abs() < 0.2, "{}", short[right.index() - 10]);
    let useless = with(30.0);
    assert!(mean_error(&useless, |v| without[v]) < 0.02);
}

#[test]
fn loose_vertices_are_reached_only_over_links() {
    let mut mesh = grid(3, 3, 1.0);
    mesh.positions.extend([0, 1].map(|v| 9.0 * mesh.positions[v]));
    let links = vec![
        Link { ends: [VertexId(8), VertexId(9)], length: 2.5 },
        Link { ends: [VertexId(4), VertexId(4)], length: 1.0 },
    ];
    let method = heat(&mesh.intrinsic().with_links(links));
    let found = method.distances(VertexId(8)).unwrap();
    assert!((found[9] - 2.5).abs() < 0.3 && found[10] == f64::INFINITY, "{found:?}");
    let back = method.distances(VertexId(9)).unwrap();
    assert!(back[9] == 0.0 && (back[8] - 2.5).abs() < 0.3 && back[0] > 4.0, "{back:?}");
    let alone = method.distances(VertexId(10)).unwrap();
    assert!(alone.iter().enumerate().all(|(v, d)| if v == 10 { *d == 0.0 } else { *d == f64::INFINITY }));
}

#[test]
fn heat_reaches_the_far_end_of_a_very_long_surface() {
    let pipe = cylinder(4, 4000, 0.5, 3000.0);
    let method = heat(&pipe.intrinsic());
    let found = method.distances(VertexId(0)).unwrap();
    let far = found.len() - 4;
    assert!((found[far] / 3000.0 - 1.0).abs() < 0.01, "{}", found[far]);
    assert!((0..found.len() - 4).all(|v| found[v + 4] > found[v] || v < 4));
}

#[test]
fn invalid_times_are_rejected() {
    let mesh = icosphere(0).intrinsic();
    for time in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = HeatMethod::new(&mesh, HeatOptions { time }, &()).unwrap_err();
        assert!(matches!(error, GeodesicError::BadHeatTime { .. }), "{error}");
    }
    // The entries of the matrix overflow.
    let error = HeatMethod::new(&mesh, HeatOptions { time: f64::MAX }, &()).unwrap_err();
    assert!(matches!(error, GeodesicError::NotFactorized(_)), "{error}");
    // A long time is still a direction.
    let long = HeatMethod::new(&mesh, HeatOptions { time: 1e6 }, &()).unwrap();
    assert!(long.distances(VertexId(0)).unwrap().iter().all(|d| d.is_finite()));
}
