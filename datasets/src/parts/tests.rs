//! Every part is the solid that its parameters describe.

use std::collections::HashSet;

use mesh::validate;

use super::*;

fn all() -> Vec<MechanicalPart> {
    mechanical_parts(1, 1000)
}

fn meshes(part: &MechanicalPart) -> Vec<(PartMesh, TriMesh)> {
    let options = [(32, Diagonals::Clipped), (32, Diagonals::Even), (17, Diagonals::Clipped)];
    let of = |(arcs, diagonals)| (PartMesh { arcs, diagonals }, part.mesh(&PartMesh { arcs, diagonals }));
    options.into_iter().map(of).collect()
}

#[test]
fn parts_are_closed_surfaces_of_the_right_genus_that_face_outwards() {
    for part in all().iter().step_by(7) {
        for (options, mesh) in meshes(part) {
            let report = validate(&mesh);
            let context = format!("{} {options:?}: {report:?}", part.name());
            assert!(report.is_clean() && report.n_boundary_edges == 0, "{context}");
            assert_eq!((report.n_components, report.inconsistent_edges), (1, 0), "{context}");
            assert_eq!(report.euler_characteristic, 2 - 2 * part.genus() as i64, "{context}");
            assert!(mesh.signed_volume() > 0.0, "{context}");
            assert!(mesh.face_areas().all(|area| area > 1e-6), "{context}");
        }
    }
}

#[test]
fn volumes_approach_those_of_the_formulas() {
    for part in mechanical_parts(2, 60) {
        let Some(exact) = part.volume() else { continue };
        let error = |arcs| {
            let mesh = part.mesh(&PartMesh { arcs, ..PartMesh::default() });
            (mesh.signed_volume() / exact - 1.0).abs()
        };
        let (coarse, fine) = (error(32), error(128));
        assert!(coarse < 0.025 && fine < coarse / 12.0 + 1e-12, "{}: {coarse} {fine}", part.name());
    }
}

#[test]
fn other_diagonals_keep_vertices_area_and_volume() {
    for part in mechanical_parts(3, 48) {
        let [clipped, even] = [Diagonals::Clipped, Diagonals::Even]
            .map(|diagonals| part.mesh(&PartMesh { diagonals, ..PartMesh::default() }));
        assert_eq!(clipped.positions, even.positions);
        assert_ne!(clipped.faces, even.faces, "{}", part.name());
        assert!((clipped.area() / even.area() - 1.0).abs() < 1e-9, "{}", part.name());
        assert!((clipped.signed_volume() / even.signed_volume() - 1.0).abs() < 1e-9, "{}", part.name());
    }
}

#[test]
fn lists_are_reproducible_without_duplicates_and_full_of_near_parts() {
    let parts = mechanical_parts(5, 112);
    assert_eq!(parts, mechanical_parts(5, 200)[..112]);
    assert_ne!(parts, mechanical_parts(6, 112));
    assert_eq!(parts.iter().map(MechanicalPart::name).collect::<HashSet<_>>().len(), 112);
    assert_eq!(parts.iter().map(MechanicalPart::family).collect::<HashSet<_>>().len(), PartFamily::ALL.len());
    let pairs = parts.iter().enumerate().flat_map(|(i, a)| parts[..i].iter().map(move |b| a.differences(b)));
    let near = pairs.filter(|differences| differences.as_ref().is_some_and(|d| d.len() == 1)).count();
    assert!(near >= 80, "{near}");
    assert!(all().len() > 300, "{}", all().len());
}
