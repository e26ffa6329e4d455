//! The content of mesh files.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use base::files::FileError;
use base::{ContentHash, ContentHasher};
use mesh_io::ReadLimits;

use crate::error::CollectionError;
use crate::storage::{Storage, member_of, mesh_at, open_archive};

/// The hash of the files of a mesh, by which an index recognizes them. A member of an archive has the hash of the same file
/// outside.
///
/// # Errors
/// [`CollectionError`] if a file cannot be read.
pub fn content_hash(path: &Path) -> Result<ContentHash, CollectionError> {
    let mut hasher = ContentHasher::default();
    for path in &mesh_io::files_in(&mesh_at(path)?, &Storage) {
        match member_of(path) {
            Some(_) => hasher.add(&content_of(path)?),
            None => {
                hasher.add_file(&mut open_regular(path)?).map_err(|source| FileError::read(path, source))?
            }
        }
    }
    Ok(hasher.finish())
}

/// All bytes of a file, or of a member of an archive.
///
/// # Errors
/// [`CollectionError`] if it cannot be read.
pub fn content_of(path: &Path) -> Result<Vec<u8>, CollectionError> {
    if let Some((archive, name)) = member_of(path) {
        return Ok(open_archive(&archive)?.read(&name, path)?);
    }
    let mut bytes = Vec::new();
    open_regular(path)?.read_to_end(&mut bytes).map_err(|source| FileError::read(path, source))?;
    Ok(bytes)
}

/// Opens a file. A pipe or a device would block, or never end, and no reader takes a larger file.
fn open_regular(path: &Path) -> Result<File, FileError> {
    let open = || {
        let about = std::fs::metadata(path)?;
        let most = ReadLimits::default().max_bytes;
        match about.is_file() {
            true if about.len() <= most => File::open(path),
            true => Err(io::Error::other(format!("{} bytes are more than {most}", about.len()))),
            false => Err(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file")),
        }
    };
    open().map_err(|source| FileError::read(path, source))
}
