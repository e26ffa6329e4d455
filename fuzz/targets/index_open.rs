//! A damaged index: every way to read it ends with an error or with what was stored.
//!
//! An input is a list of changes to the bytes of an intact index: four bytes of place, one of length, then the new bytes.

#![no_main]

use std::panic;
use std::path::PathBuf;
use std::sync::OnceLock;

use canonform::DescribeOptions;
use canonform::library::{BuildOptions, build_index};
use canonform::search::{SearchOptions, ShapeSearch};
use canonform_fuzz::single_threaded;
use libfuzzer_sys::fuzz_target;
use mesh::shapes;
use tempfile::TempDir;

/// The bytes of an intact index, and the file to write damaged ones to.
fn intact() -> &'static (Vec<u8>, PathBuf) {
    static INTACT: OnceLock<(TempDir, (Vec<u8>, PathBuf))> = OnceLock::new();
    let build = || {
        let folder = tempfile::tempdir().expect("a folder");
        let meshes = folder.path().join("meshes");
        std::fs::create_dir(&meshes).expect("a folder");
        for (name, mesh) in [("ball1.off", shapes::icosphere(2)), ("ring1.off", shapes::torus(24, 12, 2.0, 0.7))] {
            mesh_io::write(&meshes.join(name), &mesh).expect("a mesh");
        }
        let path = folder.path().join("intact.canonform");
        let describe = DescribeOptions::default();
        build_index(&meshes, &path, &BuildOptions::new(&describe), &()).expect("an index");
        let bytes = std::fs::read(&path).expect("an index");
        let damaged = folder.path().join("damaged.canonform");
        (folder, (bytes, damaged))
    };
    &INTACT.get_or_init(build).1
}

fn start() {
    single_threaded();
    // libFuzzer's hook ends the process at every panic, even at those that the library catches and turns into errors.
    drop(panic::take_hook());
    intact();
}

fuzz_target!(init: start(), |data: &[u8]| {
    let (bytes, path) = intact();
    let mut damaged = bytes.clone();
    let mut rest = data;
    while let Some((header, tail)) = rest.split_first_chunk::<5>() {
        let [a, b, c, d, length] = *header;
        let at = u32::from_le_bytes([a, b, c, d]) as usize % damaged.len();
        let length = usize::from(length).min(tail.len()).min(damaged.len() - at);
        damaged[at..at + length].copy_from_slice(&tail[..length]);
        rest = &tail[length..];
    }
    // The log of an earlier input is not that of this one.
    for suffix in ["-wal", "-shm"] {
        let _ = std::fs::remove_file(format!("{}{suffix}", path.display()));
    }
    std::fs::write(path, &damaged).expect("a file");
    let _ = index::verify(path);
    if let Ok(search) = ShapeSearch::open(path) {
        for entry in search.index().entries().unwrap_or_default() {
            let id = entry.id.as_str();
            assert!(["ball1", "ring1"].contains(&id), "a shape `{id}` that was never stored");
            assert_eq!(entry.label, id.trim_end_matches('1'), "another label");
        }
        let options = SearchOptions::default();
        let query = search.query_of("ball1", &options, &());
        if let Ok(found) = query.and_then(|query| search.search(&query, &options, &())) {
            assert_eq!(found.results.len(), 2, "a shape is missing without an error");
            assert_eq!(found.results[0].id, "ball1", "a wrong answer without an error");
        }
        let _ = search.index().export(&mut std::io::sink());
    }
});
