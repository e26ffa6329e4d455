//! Where the bytes of a mesh come from: the disk, or memory.

use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::Path;

use files::FileError;

use crate::error::{Fault, MeshError};

/// A file in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryFile<'a> {
    /// Its name; the extension tells the format, the rest serves messages.
    pub name: &'a Path,
    /// All that is in it.
    pub bytes: &'a [u8],
}

/// Where files are looked up.
pub(super) trait Source {
    /// Whether there is a file of this name.
    fn holds(&self, path: &Path) -> bool;

    /// All bytes of a file, at least one.
    fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>, MeshError>;
}

/// The file system; regular files only.
pub(super) struct Disk;

impl Source for Disk {
    fn holds(&self, path: &Path) -> bool {
        path.exists()
    }

    fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>, MeshError> {
        let cannot_read = |source| FileError::read(path, source).into();
        if !fs::metadata(path).map_err(cannot_read)?.is_file() {
            return Err(cannot_read(io::Error::new(io::ErrorKind::InvalidInput, "not a regular file")));
        }
        let bytes = fs::read(path).map_err(cannot_read)?;
        not_empty(path, bytes.into())
    }
}

/// Files in memory, and no others.
pub(super) struct Memory<'a>(pub(super) &'a [MemoryFile<'a>]);

impl Source for Memory<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.0.iter().any(|file| file.name == path)
    }

    fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>, MeshError> {
        let missing = || FileError::read(path, io::ErrorKind::NotFound.into());
        let file = self.0.iter().find(|file| file.name == path).ok_or_else(missing)?;
        not_empty(path, file.bytes.into())
    }
}

fn not_empty<'a>(path: &Path, bytes: Cow<'a, [u8]>) -> Result<Cow<'a, [u8]>, MeshError> {
    match bytes.is_empty() {
        true => Err(Fault::Empty.whole().in_file(path)),
        false => Ok(bytes),
    }
}
