//! Laws of the report of a mesh.

use canonform_mesh::{TriMesh, shapes, validate};
use surface::VertexId;

fn from(points: usize, faces: &[[u32; 3]]) -> TriMesh {
    let place = |i: usize| nalgebra::Point3::new(i as f64, (i * i % 7) as f64, (i * i * i % 11) as f64);
    TriMesh {
        positions: (0..points).map(place).collect(),
        faces: faces.iter().map(|f| f.map(VertexId)).collect(),
    }
}

#[test]
fn a_sheet_has_its_known_measures() {
    let report = validate(&shapes::grid(4, 3, 2.0));
    assert_eq!((report.n_vertices, report.n_faces, report.n_edges), (12, 12, 23));
    assert_eq!((report.n_boundary_edges, report.n_boundary_loops), (10, 1));
    assert_eq!((report.euler_characteristic, report.genus), (1, None));
    assert_eq!((report.area, report.obtuse_share), (24.0, 0.0));
    assert_eq!((report.min_edge_length, report.max_edge_length), (2.0, 8f64.sqrt()));
    assert!((report.bounding_box_diagonal - 52f64.sqrt()).abs() < 1e-12);
    assert_eq!((report.size, report.volume), ([6.0, 4.0, 0.0], None));
    let mut stray = shapes::grid(4, 3, 2.0);
    stray.positions.push([1e3, -1e3, 1e3].into());
    assert_eq!(validate(&stray).size, [6.0, 4.0, 0.0]);
    let mut cube = shapes::cube(1);
    let report = validate(&cube);
    assert!(report.size == [1.0; 3] && (report.volume.unwrap() - 1.0).abs() < 1e-12, "{report:?}");
    cube.faces[0].swap(0, 1);
    assert_eq!(validate(&cube).volume, None);
    assert_eq!(validate(&shapes::sheared_grid(4, 3, 1.0, 1.5)).obtuse_share, 1.0);
}

#[test]
fn every_defect_is_counted_once() {
    let dirty = from(9, &[[0, 1, 2], [2, 1, 0], [3, 3, 4], [1, 0, 5], [0, 1, 6], [5, 5, 5]]);
    let report = validate(&dirty);
    assert_eq!((report.degenerate_faces, report.duplicate_faces), (2, 1));
    assert_eq!((report.non_manifold_edges, report.n_boundary_edges), (1, 6));
    assert_eq!((report.unreferenced_vertices, report.n_components), (2, 1));
    assert_eq!(report.component_faces, [3]);
    assert_eq!((report.non_manifold_vertices, report.genus), (0, None));
}

#[test]
fn meshes_without_faces_or_vertices_have_a_report() {
    for mesh in [TriMesh::default(), from(3, &[]), from(2, &[[0, 0, 1]])] {
        let report = validate(&mesh);
        assert_eq!((report.n_components, report.n_edges, report.mean_edge_length), (0, 0, 0.0));
        assert!(serde_json::to_string(&report).unwrap().contains("\"genus\":null"));
    }
}
