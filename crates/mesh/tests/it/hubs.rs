//! Meshes with vertices and edges of very many faces, through all that happens before distances. Anything quadratic in
//! the number of faces at a vertex would take hours here.

use canonform_mesh::{
    ComponentPolicy, MeshReport, Orient, RepairOptions, TriMesh, Weld, orient_consistently, repair, validate,
};
use nalgebra::Point3;
use surface::laplacian::Laplacian;
use surface::{Loops, OneRing, Triangulation, VertexId, components_with_links};

const MANY: u32 = 100_000;

fn mesh(positions: Vec<Point3<f64>>, faces: impl Iterator<Item = [u32; 3]>) -> TriMesh {
    TriMesh { positions, faces: faces.map(|f| f.map(VertexId)).collect() }
}

/// A point of a circle, from 0 to 1 around it.
fn on_circle(turn: f64) -> Point3<f64> {
    let (sin, cos) = (std::f64::consts::TAU * turn).sin_cos();
    Point3::new(cos, sin, 0.0)
}

/// Takes a mesh through repair, orientation, one-rings, flips and the Laplacian; returns its report.
fn prepare(mesh: &TriMesh, options: &RepairOptions) -> MeshReport {
    let repaired = repair(mesh, options, &()).unwrap();
    let intrinsic = repaired.intrinsic;
    let topology = intrinsic.topology();
    let mut ring = OneRing::default();
    for vertex in (0..topology.n_vertices()).map(VertexId::from) {
        ring.collect(topology, vertex);
        let n_corners: usize = ring.fans().map(|fan| fan.corners.len()).sum();
        assert_eq!(n_corners, topology.vertex_corners(vertex).len());
    }
    Triangulation::new(&intrinsic).flip_to_delaunay(Loops::Forbidden);
    let masses = Laplacian::new(&intrinsic).masses();
    assert!(masses.iter().all(|mass| mass.is_finite()));
    assert_eq!(components_with_links(&intrinsic).count, 1);
    orient_consistently(&mut repaired.mesh.clone());
    validate(&repaired.mesh)
}

#[test]
fn a_polygon_with_very_many_corners() {
    let rim = (0..MANY).map(|i| on_circle(f64::from(i) / f64::from(MANY))).collect();
    let report = prepare(&mesh(rim, (1..MANY - 1).map(|i| [0, i, i + 1])), &RepairOptions::default());
    assert_eq!((report.n_boundary_loops, report.n_faces), (1, MANY as usize - 2));
}

#[test]
fn a_closed_fan_around_one_vertex() {
    let rim = (0..MANY).map(|i| on_circle(f64::from(i) / f64::from(MANY)));
    let points = std::iter::once(Point3::origin()).chain(rim).collect();
    let report =
        prepare(&mesh(points, (0..MANY).map(|i| [0, 1 + i, 1 + (i + 1) % MANY])), &RepairOptions::default());
    assert_eq!((report.non_manifold_vertices, report.n_boundary_loops), (0, 1));
}

#[test]
#[ignore = "slow: make test-all"]
fn needles_that_meet_in_one_vertex() {
    let rim = (0..2 * MANY).map(|i| on_circle(f64::from(i) / f64::from(2 * MANY)));
    let points: Vec<_> = std::iter::once(Point3::origin()).chain(rim).collect();
    let star = mesh(points, (0..MANY).map(|i| [0, 2 * i + 1, 2 * i + 2]));
    assert_eq!(prepare(&star, &RepairOptions::default()).non_manifold_vertices, 1);
    // The same needles, each with a tip of its own, welded and linked.
    let apart = testkit::soup(&star);
    assert_eq!(prepare(&apart, &RepairOptions::default()).non_manifold_vertices, 1);
    let bridge = ComponentPolicy::Bridge;
    for weld in [Weld::None, Weld::Within(0.5), Weld::Seams] {
        let mut jittered = apart.clone();
        for (v, p) in jittered.positions.iter_mut().enumerate() {
            p.z += 1e-9 * (v % 7) as f64;
        }
        let report = prepare(&jittered, &RepairOptions { components: bridge, weld, orient: Orient::Keep });
        assert!(report.n_faces <= MANY as usize);
    }
}

#[test]
fn very_many_faces_on_one_edge() {
    let points = [Point3::new(0.0, 0.0, -1.0), Point3::new(0.0, 0.0, 1.0)];
    let pages = (0..MANY).map(|i| on_circle(f64::from(i) / f64::from(MANY)));
    let book = mesh(points.into_iter().chain(pages).collect(), (0..MANY).map(|i| [0, 1, i + 2]));
    assert_eq!(prepare(&book, &RepairOptions::default()).non_manifold_edges, 1);
}
