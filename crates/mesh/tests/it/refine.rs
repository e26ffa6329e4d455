//! Laws of refined meshes.

use canonform_mesh::{Remapped, TriMesh, refine, shapes, validate};
use nalgebra::Point3;
use surface::VertexId;
use testkit::mesh as of;

/// A round plate: an n-gon cut into needles from its center, with a rim that is no part of the plane.
fn plate() -> TriMesh {
    let n = 200;
    let at = |i: usize, z: f64| {
        let angle = std::f64::consts::TAU * i as f64 / n as f64;
        Point3::new(angle.cos(), angle.sin(), z)
    };
    let positions = (0..n).flat_map(|i| [at(i, 0.0), at(i, 0.1)]).chain([Point3::origin()]).collect();
    let next = |i: usize| VertexId::from((i + 2) % (2 * n));
    let faces = (0..2 * n).step_by(2).flat_map(|i| {
        let [a, b, up] = [VertexId::from(i), next(i), VertexId::from(i + 1)];
        [[VertexId::from(2 * n), a, b], [a, up, b], [b, up, next(i + 1)]]
    });
    TriMesh { positions, faces: faces.collect() }
}

#[test]
fn no_edge_is_longer_than_asked_and_the_surface_is_the_same() {
    // A square of two sides with other diagonals, of which one is longer: flipped, both would have the shorter one.
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.2, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let bag = of(&corners, &[[0, 1, 2], [0, 2, 3], [1, 0, 3], [1, 3, 2]]);
    // The plate needs as many vertices as equilateral triangles of half this length have, its needles 4,000.
    for (mesh, longest, sizes) in [
        (shapes::tetrahedron(0), 0.48, 17..1000),
        (shapes::grid(4, 3, 1.0), 0.24, 49..1000),
        (shapes::torus(17, 6, 2.0, 0.6), 0.19, 409..5000),
        (plate(), 0.1, 1000..1900),
        (bag, 0.3, 41..1000),
    ] {
        let before = validate(&mesh);
        let Remapped { mesh: fine, remap } = refine(&mesh, longest, usize::MAX);
        let after = validate(&fine);
        assert!(after.max_edge_length <= longest && sizes.contains(&after.n_vertices), "{after:?}");
        assert!((after.area / before.area - 1.0).abs() < 1e-12);
        assert_eq!((after.genus, after.n_boundary_loops), (before.genus, before.n_boundary_loops));
        assert_eq!((after.non_manifold_edges, after.inconsistent_edges, after.zero_area_faces), (0, 0, 0));
        assert_eq!(fine.positions[..mesh.n_vertices()], mesh.positions);
        assert_eq!((remap.n_old(), remap.n_new()), (mesh.n_vertices(), fine.n_vertices()));
        assert!((0..remap.n_new()).all(|v| remap.to_old(v.into()).index() < mesh.n_vertices()));
    }
}

#[test]
fn short_edges_stay_and_the_number_of_vertices_is_bounded() {
    let mesh = shapes::icosphere(2);
    assert_eq!(refine(&mesh, 1.0, usize::MAX).mesh, mesh);
    assert_eq!(refine(&mesh, 1e-9, mesh.n_vertices()).mesh, mesh);
    let bounded = refine(&mesh, 1e-9, 5000).mesh;
    assert!((1000..=5000).contains(&bounded.n_vertices()));
}

#[test]
fn edges_of_three_faces_stay_joined() {
    let at = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 0.2, 0.0], [0.5, -0.2, 0.0], [0.5, 0.0, 0.2]];
    let mesh = of(&at, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    let found = refine(&mesh, 0.6, usize::MAX).mesh;
    assert_eq!((found.n_vertices(), found.n_faces()), (6, 6));
    assert_eq!(validate(&found).non_manifold_edges, 2);
}
