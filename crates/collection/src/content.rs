//! The content of mesh files.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};

use base::ContentHash;
use base::files::FileError;
use mesh::io::{FileSource, Opened, ReadLimits};

use crate::error::CollectionError;
use crate::storage::{Storage, member_of};

/// The hash of the files of a mesh, by which an index recognises them. A member of an archive has the hash of the same file
/// outside.
///
/// # Errors
/// [`CollectionError`] if a file cannot be read.
pub fn content_hash(path: &Path) -> Result<ContentHash, CollectionError> {
    hash(&mesh::io::files_in(path, &Storage))
}

fn hash(files: &[PathBuf]) -> Result<ContentHash, CollectionError> {
    if files.iter().any(|file| member_of(file).is_some()) {
        let pieces = files.iter().map(|file| content_of(file)).collect::<Result<Vec<_>, _>>()?;
        return Ok(ContentHash::of(&pieces));
    }
    let mut open = Vec::new();
    for path in files {
        open.push((path.as_path(), open_regular(path)?));
    }
    Ok(ContentHash::of_files(open.iter_mut().map(|(path, file)| (*path, file)))
        .map_err(|(path, source)| FileError::read(&path, source))?)
}

/// All bytes of a file, or of a member of an archive.
///
/// # Errors
/// [`CollectionError`] if it cannot be read.
pub fn content_of(path: &Path) -> Result<Vec<u8>, CollectionError> {
    if member_of(path).is_none() {
        let mut bytes = Vec::new();
        let read = io::Read::read_to_end(&mut open_regular(path)?, &mut bytes);
        read.map_err(|source| FileError::read(path, source))?;
        return Ok(bytes);
    }
    match Storage.open(path)? {
        Opened::Bytes(bytes) => Ok(bytes.into_owned()),
        Opened::Stream(mut stream, _) => {
            let mut bytes = Vec::new();
            stream.read_to_end(&mut bytes).map_err(|source| FileError::read(path, source))?;
            Ok(bytes)
        }
    }
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
