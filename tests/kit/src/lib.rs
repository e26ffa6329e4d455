//! What tests of several crates share: meshes, files and archives, real data, numbers of threads.

#![allow(clippy::unwrap_used, reason = "failures are those of tests")]

use std::collections::BTreeMap;
use std::fs;
use std::io::{Cursor, Write};
use std::path::{Path, PathBuf};

use flate2::Compression;
use flate2::write::GzEncoder;
use mesh::TriMesh;
use nalgebra::Point3;
use zip::write::SimpleFileOptions;

/// A folder of real meshes, which are not part of the project: below `CANONFORM_DATA`, or `../shared/data` beside the
/// workspace. Without it, the tests that need it print a note and pass.
pub fn data(folder: &str) -> Option<PathBuf> {
    let default = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data");
    let path = std::env::var_os("CANONFORM_DATA").map_or_else(default, PathBuf::from).join(folder);
    if !path.is_dir() {
        println!("skipped: no folder {}; set CANONFORM_DATA", path.display());
        return None;
    }
    Some(path)
}

/// Shape and numbers of a NumPy array, which has this type of numbers and is in C order.
pub fn array<T: npyz::Deserialize + npyz::AutoSerialize>(path: &Path) -> (Vec<u64>, Vec<T>) {
    let bytes = fs::read(path).unwrap();
    let file = npyz::NpyFile::new(&bytes[..]).unwrap();
    assert_eq!((file.dtype().descr(), file.order()), (T::default_dtype().descr(), npyz::Order::C));
    (file.shape().to_vec(), file.into_vec().unwrap())
}

/// Runs work on a pool of so many threads.
pub fn on_threads<T: Send>(n: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(n).build().unwrap().install(work)
}

/// All files below a folder by their paths in it, and links by where they lead.
pub fn tree(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap().map(Result::unwrap) {
        let (path, kind, name) = (entry.path(), entry.file_type().unwrap(), PathBuf::from(entry.file_name()));
        if kind.is_dir() {
            found.extend(tree(&path).into_iter().map(|(below, bytes)| (name.join(below), bytes)));
        } else if kind.is_symlink() {
            found.insert(name, fs::read_link(&path).unwrap().into_os_string().into_encoded_bytes());
        } else {
            found.insert(name, fs::read(&path).unwrap());
        }
    }
    found
}

/// The content of a mesh file of this name.
pub fn written(name: &str, mesh: &TriMesh) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    mesh_io::write(&folder.path().join(name), mesh).unwrap();
    fs::read(folder.path().join(name)).unwrap()
}

/// A zip archive of files.
pub fn zip_of(files: &[(impl AsRef<str>, impl AsRef<[u8]>)]) -> Vec<u8> {
    let mut archive = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, content) in files {
        archive.start_file(name.as_ref(), SimpleFileOptions::default()).unwrap();
        archive.write_all(content.as_ref()).unwrap();
    }
    archive.finish().unwrap().into_inner()
}

/// A tar archive of files, whose names may lead out of it.
pub fn tar_of(files: &[(impl AsRef<str>, impl AsRef<[u8]>)]) -> Vec<u8> {
    let mut archive = tar::Builder::new(Vec::new());
    for (name, content) in files {
        let mut header = tar::Header::new_gnu();
        header.set_size(content.as_ref().len() as u64);
        header.set_mode(0o644);
        // The library refuses to write names that lead out of the archive.
        header.as_old_mut().name[..name.as_ref().len()].copy_from_slice(name.as_ref().as_bytes());
        header.set_cksum();
        archive.append(&header, content.as_ref()).unwrap();
    }
    archive.into_inner().unwrap()
}

/// Compressed bytes.
pub fn gzip_of(bytes: &[u8]) -> Vec<u8> {
    let mut out = GzEncoder::new(Vec::new(), Compression::default());
    out.write_all(bytes).unwrap();
    out.finish().unwrap()
}

/// A mesh of these points and faces.
pub fn mesh(points: &[[f64; 3]], faces: &[[u32; 3]]) -> TriMesh {
    let faces = faces.iter().map(|face| face.map(|v| (v as usize).into()));
    TriMesh { positions: points.iter().map(|p| Point3::from(*p)).collect(), faces: faces.collect() }
}

/// The mesh with every point where a motion takes it.
pub fn moved(mesh: &TriMesh, motion: impl FnMut(&Point3<f64>) -> Point3<f64>) -> TriMesh {
    TriMesh { positions: mesh.positions.iter().map(motion).collect(), faces: mesh.faces.clone() }
}

/// The same faces, each with vertices of its own.
pub fn soup(mesh: &TriMesh) -> TriMesh {
    let faces = (0..mesh.n_faces()).map(|f| [3 * f, 3 * f + 1, 3 * f + 2].map(Into::into));
    TriMesh {
        faces: faces.collect(),
        positions: (0..mesh.n_faces()).flat_map(|f| mesh.triangle(f)).collect(),
    }
}

/// The mesh with its vertices and faces in reverse order.
pub fn renumbered(mesh: &TriMesh) -> TriMesh {
    let last = mesh.n_vertices() - 1;
    let faces = mesh.faces.iter().rev().map(|face| face.map(|v| (last - v.index()).into()));
    TriMesh { positions: mesh.positions.iter().rev().copied().collect(), faces: faces.collect() }
}

/// The mesh with a crack: a vertex is there twice, as the last one of two of its faces.
pub fn cracked(mesh: &TriMesh, vertex: usize) -> TriMesh {
    let mut mesh = mesh.clone();
    let twin = mesh.n_vertices();
    mesh.positions.push(mesh.positions[vertex]);
    let faces = mesh.faces.iter_mut().filter(|face| face.iter().any(|v| v.index() == vertex));
    faces.take(2).flatten().filter(|v| v.index() == vertex).for_each(|v| *v = twin.into());
    mesh
}
