//! Real meshes with all their defects through reading, validation and repair.

use std::path::{Path, PathBuf};

use canonform_mesh_io as io;
use mesh::{ComponentPolicy, RepairOptions, TriMesh, repair, validate};
use testkit::data;

/// The mesh paths of a folder, sorted.
fn meshes_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut paths: Vec<PathBuf> = entries.filter(|path| io::is_mesh_path(path)).collect();
    paths.sort();
    paths
}

/// The laws of repair under every policy.
fn assert_repairs(path: &Path, mesh: &TriMesh) {
    for components in [ComponentPolicy::Largest, ComponentPolicy::Bridge] {
        let (options, name) = (RepairOptions { components, ..Default::default() }, path.display());
        let repaired = repair(mesh, &options, &()).unwrap();
        let after = validate(&repaired.mesh);
        assert_eq!(after.degenerate_faces + after.duplicate_faces + after.unreferenced_vertices, 0, "{name}");
        let pieces = if components == ComponentPolicy::Largest { 1 } else { repaired.report.components };
        assert_eq!(after.n_components, pieces, "{name}");
        // A second repair changes nothing.
        let again = repair(&repaired.mesh, &options, &()).unwrap();
        assert_eq!(again.mesh, repaired.mesh, "{name}");
        assert_eq!(again.report.bridges.len(), repaired.intrinsic.links().len());
    }
}

#[test]
fn all_tosca_shapes_load_and_can_be_repaired_except_the_one_without_faces() {
    let Some(folder) = data("tosca-lowres") else { return };
    let paths = meshes_in(&folder);
    assert_eq!(paths.len(), 148);
    for (i, path) in paths.iter().enumerate() {
        match io::read(path) {
            Ok(mesh) => {
                assert_eq!(io::read(&path.with_extension("tri")).unwrap(), mesh);
                // Poses of one animal have the same defects.
                if i % 3 == 0 {
                    assert_repairs(path, &mesh);
                }
            }
            Err(error) => {
                let text = error.to_string();
                assert!(text.ends_with("victoria14.tri: the file is empty"), "{text}");
            }
        }
    }
}

#[test]
fn matlab_files_equal_the_text_files() {
    let (Some(mat), Some(text)) = (data("tosca-mat"), data("tosca-lowres")) else { return };
    for (name, n_faces) in [("cat0", 6768), ("centaur0", 6796), ("victoria14", 6768)] {
        let from_mat = io::read(&mat.join(name).with_extension("mat")).unwrap();
        assert_eq!((from_mat.n_vertices(), from_mat.n_faces()), (3400, n_faces));
        assert_repairs(&mat.join(name), &from_mat);
        // The text has eight decimals.
        let Ok(from_text) = io::read(&text.join(name).with_extension("vert")) else { continue };
        assert_eq!(from_mat.faces, from_text.faces);
        for (p, q) in from_mat.positions.iter().zip(&from_text.positions) {
            assert!((p - q).norm() < 1e-7);
        }
    }
    let david = io::read(&mat.join("david0-hires.mat")).unwrap();
    assert_eq!(david.n_vertices(), 52_565);
    assert_repairs(&mat, &david);
}

#[test]
fn scans_load_with_all_their_vertices_and_can_be_repaired() {
    let Some(folder) = data("single") else { return };
    for (name, n_vertices, n_faces, unused) in [
        ("spot", 2_930, 5_856, 0),
        ("rocker-arm", 10_044, 20_088, 0),
        ("stanford-bunny", 35_947, 69_451, 1_113),
        ("armadillo", 43_243, 86_482, 0),
        ("ogre", 62_194, 124_008, 0),
    ] {
        let path = folder.join(name).with_extension("obj");
        let mesh = io::read(&path).unwrap();
        let report = validate(&mesh);
        let found = (report.n_vertices, report.n_faces, report.unreferenced_vertices);
        assert_eq!(found, (n_vertices, n_faces, unused), "{name}");
        assert_repairs(&path, &mesh);
    }
}
