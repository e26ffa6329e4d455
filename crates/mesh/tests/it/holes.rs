//! Laws of holes that are filled.

use canonform_mesh::{TriMesh, fill_holes, shapes, validate};

/// A torus without the faces at some vertices.
fn pierced(vertices: &[u32]) -> TriMesh {
    let mut mesh = shapes::torus(40, 20, 2.0, 0.7);
    mesh.faces.retain(|face| !face.iter().any(|v| vertices.contains(&v.0)));
    mesh
}

#[test]
fn holes_are_closed_and_faces_stay_oriented() {
    let mesh = pierced(&[3, 100, 500]);
    let filled = fill_holes(&mesh, &mesh.topology(), 3.0);
    let report = validate(&filled.mesh);
    assert_eq!((report.n_boundary_loops, report.flipped_faces), (0, 0), "{report:?}");
    assert_eq!(filled.mesh.positions[..mesh.n_vertices()], mesh.positions);
    assert_eq!(filled.mesh.faces[..mesh.n_faces()], mesh.faces);
    assert_eq!((filled.remap.n_old(), filled.remap.n_new()), (mesh.n_vertices(), mesh.n_vertices() + 3));
    let whole = shapes::torus(40, 20, 2.0, 0.7).area();
    assert!((filled.mesh.area() / whole - 1.0).abs() < 0.002 && mesh.area() < 0.99 * whole);
}

#[test]
fn large_holes_and_touching_ones_stay() {
    let sheet = shapes::grid(5, 5, 1.0);
    assert!(fill_holes(&sheet, &sheet.topology(), 15.9).remap.is_identity());
    assert_eq!(fill_holes(&sheet, &sheet.topology(), 16.1).mesh.n_vertices(), sheet.n_vertices() + 1);
    let mut touching = shapes::grid(6, 6, 1.0);
    touching.faces.retain(|face| {
        let corner = face.iter().map(|v| v.0).min().unwrap();
        ![7, 14].contains(&corner)
    });
    assert!(fill_holes(&touching, &touching.topology(), 6.0).remap.is_identity());
    let torus = shapes::torus(8, 8, 2.0, 0.7);
    assert!(fill_holes(&torus, &torus.topology(), 100.0).remap.is_identity());
}

#[test]
fn subdivision_and_flipped_faces_do_not_change_the_middle() {
    let mesh = pierced(&[77]);
    let expected = fill_holes(&mesh, &mesh.topology(), 3.0);
    let fine = shapes::subdivide(&mesh);
    assert!(fine.n_vertices() > 3 * mesh.n_vertices());
    let mut turned = mesh.clone();
    turned.faces.iter_mut().step_by(5).for_each(|face| face.swap(0, 2));
    for other in [fine, turned] {
        let found = fill_holes(&other, &other.topology(), 3.0);
        assert_eq!(found.mesh.n_vertices(), other.n_vertices() + 1);
        let gap = found.mesh.positions.last().unwrap() - expected.mesh.positions.last().unwrap();
        assert!(gap.norm() < 1e-12);
    }
}
