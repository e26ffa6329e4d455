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
