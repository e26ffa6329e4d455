//! Paths that can be drawn by hand.

use mesh::{TriMesh, shapes};
use surface::{FaceId, Link, VertexId};

use super::{assert_path, shortest, vertex};
use crate::tests::{assert_close, spatial};
use crate::{DistanceSolver, Exact, FastMarching, GeodesicError, PathTracer, Source, SurfacePoint};

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
fn paths_bend_at_the_corner_of_a_boundary() {
    // An L of three squares of 4 x 4 cells: the inner corner is in the way.
    let sheet = shapes::grid(9, 9, 1.0);
    let is_cut = |f: &[VertexId; 3]| f.iter().all(|v| v.0 % 9 >= 4 && v.0 / 9 >= 4);
    let faces = sheet.faces.iter().copied().filter(|f| !is_cut(f)).collect();
    let mesh = (TriMesh { faces, ..sheet }).intrinsic();
    // From (8, 2) to (1, 8) around (4, 4).
    let path = shortest(&mesh, vertex(2 * 9 + 8), vertex(8 * 9 + 1));
    assert_close(path.length, 4f64.hypot(2.0) + 3f64.hypot(4.0), 1e-13);
    assert!(path.points.contains(&vertex(4 * 9 + 4)));
}

#[test]
fn paths_between_pages_of_a_book_cross_the_spine() {
    // Four pages on one spine, along the y-axis; unfolded, every two of them are one sheet.
    let n = 6;
    let mut at: Vec<[f64; 3]> = (0..=n).map(|j| [0.0, j as f64, 0.0]).collect();
    let mut faces = Vec::new();
    for page in 0..4 {
        let (sin, cos) = (0.4 * f64::from(page)).sin_cos();
        let number =
            |i: usize, j: usize| if i == 0 { j } else { page as usize * n * (n + 1) + i * (n + 1) + j };
        for i in 1..=n {
            at.extend((0..=n).map(|j| [i as f64 * cos, j as f64, i as f64 * sin]));
        }
        for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
            let [a, b, c, d] =
                [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| number(i, j) as u32);
            // Every second page is printed upside down.
            faces.extend(if page % 2 == 0 { [[a, b, c], [a, c, d]] } else { [[b, a, c], [c, a, d]] });
        }
    }
    let mesh = spatial(&at, &faces);
    let number = |page: usize, i: usize, j: usize| vertex(page * n * (n + 1) + i * (n + 1) + j);
    for (p, q) in [(0, 1), (1, 3), (2, 0), (3, 2)] {
        let path = shortest(&mesh, number(p, 5, 1), number(q, 3, 6));
        assert_close(path.length, 8f64.hypot(5.0), 1e-13);
    }
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
    let mut distances = vec![0.0; mesh.n_vertices()];
    FastMarching::new(&mesh, Default::default(), &())
        .solve_into(&sources, f64::INFINITY, &mut distances)
        .unwrap();
    let tracer = PathTracer::new(&mesh, &sources, &distances, &());
    let corners = mesh.topology().faces()[100].map(|v| sheet.positions[v.index()].coords);
    let inside = corners[0] * 0.2 + corners[1] * 0.5 + corners[2] * 0.3;
    let places = [sheet.positions[3].coords, inside, sheet.positions[115].coords];
    for v in 0..mesh.n_vertices() {
        let path = tracer.path_to(vertex(v)).unwrap();
        let away = places.map(|place| (sheet.positions[v].coords - place).norm());
        let nearest = (0..3).min_by(|i, j| away[*i].total_cmp(&away[*j])).unwrap();
        // The source in a face is marched from its corners, so close calls may go either way.
        assert_path(&mesh, &path, path.points[0], vertex(v));
        assert!(path.length >= away[nearest] * (1.0 - 1e-12) && path.length <= away[nearest] * 1.05 + 1e-12);
        assert!(sources.iter().any(|source| source.point() == path.points[0]));
    }
}
