//! Every reader of mesh files, validation, and what is written reads back.

#![no_main]

use canonform_fuzz::mesh_of;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    if let Some(mesh) = mesh_of(data, 100_000) {
        let report = mesh::validate(&mesh);
        assert_eq!((report.n_vertices, report.n_faces), (mesh.n_vertices(), mesh.n_faces()));
    }
});
