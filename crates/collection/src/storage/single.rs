//! The mesh of an archive that holds one.

use std::borrow::Cow;
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};

use base::files::FileError;
use mesh::MeshError;
use mesh_io::{FileSource, Opened, files_in, is_mesh_path};

use super::archive::Archive;
use super::cache::{members, open as open_archive};
use super::container::{Container, fault};
use crate::dataset::joined;
use crate::error::CollectionError;

/// Whether a name is that of an archive: `.zip`, `.tar`, `.tar.gz` or `.tgz`.
pub fn is_archive_name(name: &Path) -> bool {
    matches!(Container::by_name(name), Some(Container::Zip | Container::Tar))
}

/// The mesh that a path stands for: that of an archive which holds one, else what is at the path.
///
/// # Errors
/// [`CollectionError::NotOneMesh`], and [`CollectionError::Mesh`] if an archive cannot be read.
pub fn mesh_at(path: &Path) -> Result<Cow<'_, Path>, CollectionError> {
    match Container::of(path).is_some_and(Container::is_archive) {
        true => Ok(path.join(open_archive(path)?.only_mesh(path)?).into()),
        false => Ok(path.into()),
    }
}

/// The files of the only mesh in an archive in memory, that of the mesh first; names are relative to its folder. No file may
/// have more than `most` bytes, nor may what a `.tar.gz` decompresses to.
///
/// # Errors
/// [`CollectionError::NotOneMesh`], and [`CollectionError::Mesh`] if the archive cannot be read.
pub fn single_mesh(name: &Path, bytes: &[u8], most: u64) -> Result<Vec<(PathBuf, Vec<u8>)>, CollectionError> {
    let kept = |error| CollectionError::from(FileError::write(name, error));
    let mut file = base::files::nameless_in(&std::env::temp_dir()).map_err(|error| kept(error.source))?;
    file.write_all(bytes).and_then(|()| file.rewind()).map_err(kept)?;
    let container = Container::by_name(name).unwrap_or(Container::Zip);
    let archive = members(name, file, container, most).map_err(|what| fault(name, what))?;
    let mesh = archive.only_mesh(name)?;
    let source = Members { archive: &archive, name, most };
    let mesh = Path::new(mesh);
    let folder = mesh.parent().unwrap_or(Path::new(""));
    let mut files = Vec::new();
    for file in files_in(mesh, &source).into_iter().filter(|file| source.holds(file)) {
        files.push((file.strip_prefix(folder).unwrap_or(&file).to_owned(), source.content(&file)?));
    }
    files.sort_by_key(|(file, _)| !is_mesh_path(file));
    Ok(files)
}

/// The files of an archive that is not on the disk.
struct Members<'a> {
    archive: &'a Archive,
    name: &'a Path,
    most: u64,
}

impl Members<'_> {
    fn content(&self, path: &Path) -> Result<Vec<u8>, MeshError> {
        self.archive.read_at_most(&joined(path), &self.name.join(path), self.most)
    }
}

impl FileSource for Members<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.archive.member(&joined(path)).is_some()
    }

    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError> {
        Ok(Opened::of(self.content(path)?))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tar(files: &[(&str, &[u8])]) -> Vec<u8> {
        let mut archive = tar::Builder::new(Vec::new());
        for (name, content) in files {
            let mut header = tar::Header::new_gnu();
            header.set_size(content.len() as u64);
            header.set_mode(0o644);
            archive.append_data(&mut header, name, *content).unwrap();
        }
        archive.into_inner().unwrap()
    }

    #[test]
    fn an_archive_of_one_mesh_is_that_mesh_with_its_files() {
        let files =
            [("scan/cat.vert", &b"0 0 0"[..]), ("scan/cat.tri", b"1 2 3"), ("scan/notes.md", b"of a cat")];
        let found = single_mesh(Path::new("cat.tar"), &tar(&files), 1000).unwrap();
        let names: Vec<_> = found.iter().map(|(name, _)| name.to_str().unwrap()).collect();
        assert_eq!(names, ["cat.vert", "cat.tri"]);
        assert_eq!(found[1].1, b"1 2 3");
        for (files, n_meshes) in
            [(&[("a.off", &b"OFF"[..]), ("b.off", b"OFF")][..], 2), (&[("a.md", b"")], 0)]
        {
            let error = single_mesh(Path::new("all.tar"), &tar(files), 1000).unwrap_err().to_string();
            assert!(error.contains(&format!("all.tar: the archive holds {n_meshes} meshes")), "{error}");
        }
        assert!(single_mesh(Path::new("cat.zip"), b"PK", 1000).is_err());
        for (name, is_one) in
            [("a.zip", true), ("a.tar.gz", true), ("a.tgz", true), ("a.off", false), ("a.txt", false)]
        {
            assert_eq!(is_archive_name(Path::new(name)), is_one, "{name}");
        }
    }
}
