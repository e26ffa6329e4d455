//! Paths that can be drawn by hand.

use mesh::shapes;
use surface::{FaceId, Link, VertexId};

use super::{assert_path, shortest, vertex};
use crate::tests::{assert_close, distances_from};
use crate::{DistanceSolver, Exact, GeodesicError, PathTracer, Source, SurfacePoint};

#[test]
fn a_path_to_its_own_source_is_a_point() {
    let mesh = shapes::icosphere(1).intrinsic();
    let inside = SurfacePoint::Face { face: FaceId(7), barycentric: [0.25, 0.25, 0.5] };
    for point in [vertex(5), inside] {
        let path = shortest(&mesh, point, point);
        assert_eq!((path.points, path.length), (vec![point], 0.0));
    }
    // The same vertex in other words.
    let [a, _] = mesh.topology().edges()[9];
    let edge = SurfacePoint::Edge { edge: surface::EdgeId(9), t: 0.0 };
    let sources = [Source::vertex(a)];
    let distances = Exact::new(&mesh, &()).distances(a).unwrap();
    assert_eq!(PathTracer::new(&mesh, &sources, &distances, &()).path_to(edge).unwrap().length, 0.0);
}

#[test]
fn paths_cross_links_but_not_gaps_between_components() {
    let apart = shapes::disjoint(&[shapes::grid(5, 5, 1.0), shapes::grid(4, 4, 1.0)]);
    let mesh = apart.intrinsic();
    let ends = [24, 25].map(VertexId);
    let linked = mesh.clone().with_links(vec![Link { ends, length: 2.5 }]);
    let expected = 4f64.hypot(4.0) + 2.5 + 3f64.hypot(3.0);
    assert_close(shortest(&linked, vertex(0), vertex(40)).length, expected, 1e-13);
    assert_close(shortest(&linked, vertex(40), vertex(0)).length, expected, 1e-13);

    let sources = [Source::vertex(VertexId(0))];
    let distances = Exact::new(&mesh, &()).distances(VertexId(0)).unwrap();
    let tracer = PathTracer::new(&mesh, &sources, &distances, &());
    let error = tracer.path_to(vertex(40)).unwrap_err();
    assert_eq!(error, GeodesicError::NoPath { point: vertex(40) });
    assert!(error.to_string().contains("vertex 40"));
    assert!(matches!(tracer.path_to(vertex(41)), Err(GeodesicError::NoSuchVertex { .. })));
    let off = SurfacePoint::Face { face: FaceId(0), barycentric: [2.0, -1.0, 0.0] };
    assert!(matches!(tracer.path_to(off), Err(GeodesicError::BadPoint(_))));
}

#[test]
fn paths_lead_to_the_nearest_of_several_sources() {
    let sheet = shapes::jittered_grid(12, 10, 1.0, 0.2, 5);
    let mesh = sheet.intrinsic();
    let point = SurfacePoint::Face { face: FaceId(100), barycentric: [0.2, 0.5, 0.3] };
    let sources =
        [Source::vertex(VertexId(3)), Source::new(&mesh, point).unwrap(), Source::vertex(VertexId(115))];
    let distances = distances_from(&Exact::new(&mesh, &()), &sources, f64::INFINITY);
    let tracer = PathTracer::new(&mesh, &sources, &distances, &());
    let corners = mesh.topology().faces()[100].map(|v| sheet.positions[v.index()].coords);
    let inside = corners[0] * 0.2 + corners[1] * 0.5 + corners[2] * 0.3;
    let places = [sheet.positions[3].coords, inside, sheet.positions[115].coords];
    for v in 0..mesh.n_vertices() {
        let path = tracer.path_to(vertex(v)).unwrap();
        let away = places.map(|place| (sheet.positions[v].coords - place).norm());
        let nearest = (0..3).min_by(|i, j| away[*i].total_cmp(&away[*j])).unwrap();
        assert_path(&mesh, &path, sources[nearest].point(), vertex(v));
        assert!((path.length - away[nearest]).abs() < 1e-12);
    }
}
