//! Where the bytes of a mesh come from: the disk, or memory.

use std::borrow::Cow;
use std::fs;
use std::io;
use std::path::Path;

use files::FileError;

use crate::error::MeshError;

/// A file in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryFile<'a> {
    /// Its name. The extension determines the format; the rest only appears in messages.
    pub name: &'a Path,
    /// Its content.
    pub bytes: &'a [u8],
}

/// A place that holds files.
pub(super) trait Source {
    /// Whether there is a file with this name.
    fn holds(&self, path: &Path) -> bool;

    /// Reads a file.
    fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>, MeshError>;
}

/// The regular files of the file system.
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
        Ok(fs::read(path).map_err(cannot_read)?.into())
    }
}

/// Files in memory.
pub(super) struct Memory<'a>(pub(super) &'a [MemoryFile<'a>]);

impl Source for Memory<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.0.iter().any(|file| file.name == path)
    }

    fn load(&self, path: &Path) -> Result<Cow<'_, [u8]>, MeshError> {
        let missing = || FileError::read(path, io::ErrorKind::NotFound.into());
        let file = self.0.iter().find(|file| file.name == path).ok_or_else(missing)?;
        Ok(file.bytes.into())
    }
}
