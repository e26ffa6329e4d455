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

/// The number of handles of the surface: one for each hole through the part.
fn genus(part: &MechanicalPart) -> u64 {
    // Families with holes have their number as the last parameter.
    let n_holes = part.values[part.values.len() - 1] as u64;
    match part.family {
        PartFamily::Bracket => 2 * n_holes,
        PartFamily::Plate | PartFamily::Enclosure => n_holes,
        PartFamily::Gear | PartFamily::BentPipe => 1,
        _ => 0,
    }
}

#[test]
fn parts_are_closed_surfaces_of_the_right_genus_that_face_outwards() {
    for part in all().iter().step_by(7) {
        for (options, mesh) in meshes(part) {
            let report = validate(&mesh);
            let context = format!("{} {options:?}: {report:?}", part.name());
            assert!(report.volume.is_some() && mesh.signed_volume() > 0.0, "{context}");
            assert_eq!((report.unreferenced_vertices, report.duplicate_vertices), (0, 0), "{context}");
            assert_eq!(report.genus, Some(genus(part)), "{context}");
            assert!(mesh.face_areas().all(|area| area > 1e-6), "{context}");
        }
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
