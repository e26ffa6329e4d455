//! Where meshes are stored: folders, archives, Parquet files and lists of paths.
//!
//! A member of an archive has a path like any other file: `collection.zip/cat/cat0.off`. Nothing is unpacked into a folder.
//! Members of a `.zip` and a `.tar` are read where they are; a `.tar.gz` and a Parquet file are decompressed once into a
//! temporary file without a name. Threads read members at the same time.

mod archive;
mod cache;
mod container;
mod list;
mod parquet;
mod single;
mod tar;
mod window;
mod zip;

use std::path::{Path, PathBuf};

use base::files::FileError;
use mesh::{MeshError, TriMesh};
use mesh_io::{Disk, FileSource, MeshFile, Opened, ReadLimits};

use crate::error::CollectionError;
pub(crate) use cache::open as open_archive;
pub(crate) use container::{Container, has_members, is_archive_like, is_unread_archive};
pub(crate) use list::read as read_list;
pub use single::{is_archive_name, mesh_at, single_mesh};

/// Whether a path leads to a dataset: a folder, an archive (`.zip`, `.tar`, `.tar.gz`, `.tgz`), a `.parquet` file with a
/// column of bytes, or a list of paths (`.txt`, `.list`).
pub fn is_dataset(path: &Path) -> bool {
    Container::of(path).is_some()
}

/// The file system, in which archives are folders: `collection.zip/cat/cat0.off` is a file.
#[derive(Debug, Clone, Copy, Default)]
pub struct Storage;

impl FileSource for Storage {
    fn holds(&self, path: &Path) -> bool {
        path.exists()
            || member_of(path).is_some_and(|(archive, name)| {
                open_archive(&archive).is_ok_and(|archive| archive.member(&name).is_some())
            })
    }

    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError> {
        if let Some((archive, name)) = member_of(path) {
            return Ok(Opened::of(open_archive(&archive)?.read(&name, path)?));
        }
        Disk.open(path)
    }
}

impl Storage {
    /// Bytes of a file.
    pub fn n_bytes(self, path: &Path) -> Result<u64, CollectionError> {
        match member_of(path) {
            Some((archive, name)) => {
                let archive = open_archive(&archive)?;
                Ok(archive.member(&name).map_or(0, |member| member.size))
            }
            None => Ok(std::fs::metadata(path).map_err(|source| FileError::read(path, source))?.len()),
        }
    }
}

/// The archive and the name of the member that a path means. `None` for a path that exists, or that leads to no archive.
pub fn member_of(path: &Path) -> Option<(PathBuf, String)> {
    for (depth, above) in path.ancestors().enumerate() {
        if depth > 0 && Container::by_name(above).is_some_and(Container::is_archive) && above.is_file() {
            let below = path.strip_prefix(above).ok()?;
            let parts: Option<Vec<&str>> = below.iter().map(|part| part.to_str()).collect();
            return Some((above.to_owned(), parts?.join("/")));
        }
        if above.exists() {
            return None;
        }
    }
    None
}

/// Reads a mesh, which may be compressed (`cat.obj.gz`), the member of an archive (`cats.zip/cat0.off`), or the only mesh of an
/// archive (`cat.zip`).
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("ball.ply.gz");
/// mesh_io::write(&path, &mesh::shapes::icosphere(2))?;
/// assert_eq!(canonform_collection::read_mesh(&path)?.n_vertices(), 162);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`CollectionError::Mesh`], [`CollectionError::NotOneMesh`], [`CollectionError::UnreadArchive`].
pub fn read_mesh(path: &Path) -> Result<TriMesh, CollectionError> {
    Ok(read_mesh_file(path, &ReadLimits::default())?.mesh)
}

/// As [`read_mesh`], with what else the file says, such as the unit of length.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_file(path: &Path, limits: &ReadLimits) -> Result<MeshFile, CollectionError> {
    match is_unread_archive(path) {
        true => Err(CollectionError::UnreadArchive { path: path.to_owned() }),
        false => Ok(mesh_io::read_file(&mesh_at(path)?, &Storage, limits)?),
    }
}

#[cfg(test)]
mod tests;
