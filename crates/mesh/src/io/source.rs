//! Where the bytes of a mesh come from: the disk, or memory.

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use files::FileError;

use crate::error::{Fault, Located, MeshError};

/// Checks the first bytes of a file, given its size if that is known: whether the whole can be a file of the format.
pub(super) type CheckStart = fn(&[u8], Option<u64>) -> Result<(), Located>;

/// Bytes that are checked before the rest of a file is read.
const START: u64 = 16 << 10;

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

    /// Reads a file whose start passes a check.
    fn load(&self, path: &Path, check: CheckStart) -> Result<Cow<'_, [u8]>, MeshError>;
}

/// The regular files of the file system.
pub(super) struct Disk;

impl Source for Disk {
    fn holds(&self, path: &Path) -> bool {
        path.exists()
    }

    fn load(&self, path: &Path, check: CheckStart) -> Result<Cow<'_, [u8]>, MeshError> {
        let cannot_read = |source| FileError::read(path, source);
        let facts = fs::metadata(path).map_err(cannot_read)?;
        if !facts.is_file() {
            return Err(cannot_read(io::Error::new(io::ErrorKind::InvalidInput, not_regular(&facts))).into());
        }
        // A file of unknown size, as some file systems have, has the size zero.
        let size = Some(facts.len()).filter(|size| *size > 0);
        let mut file = File::open(path).map_err(cannot_read)?;
        Ok(read_checked(path, &mut file, check, size, u64::MAX)?.into())
    }
}

/// Says what kind of file cannot be read by its name.
fn not_regular(facts: &fs::Metadata) -> &'static str {
    match facts.is_dir() {
        true => "a folder is not a regular file",
        false => "a pipe or a device is not a regular file; pass its content through standard input",
    }
}

/// Reads a stream of `size` bytes, if that is known. Nothing is read beyond a start that fails the check, and at most
/// `max_bytes`.
pub(super) fn read_checked(
    path: &Path,
    stream: &mut dyn Read,
    check: CheckStart,
    size: Option<u64>,
    max_bytes: u64,
) -> Result<Vec<u8>, MeshError> {
    let cannot_read = |source| FileError::read(path, source);
    let mut bytes = Vec::new();
    stream.take(START).read_to_end(&mut bytes).map_err(cannot_read)?;
    let is_whole = (bytes.len() as u64) < START;
    check(&bytes, if is_whole { Some(bytes.len() as u64) } else { size })
        .map_err(|fault| fault.in_file(path))?;
    if !is_whole {
        let rest = size.unwrap_or(0).min(max_bytes).saturating_sub(START);
        let room = usize::try_from(rest).unwrap_or(usize::MAX);
        bytes.try_reserve_exact(room).map_err(|_| cannot_read(io::ErrorKind::OutOfMemory.into()))?;
        stream.take(max_bytes.saturating_sub(START)).read_to_end(&mut bytes).map_err(cannot_read)?;
        if bytes.len() as u64 == max_bytes && stream.read(&mut [0]).map_err(cannot_read)? > 0 {
            return Err(Fault::OverLimit { items: "bytes", limit: max_bytes }.whole().in_file(path));
        }
    }
    Ok(bytes)
}

/// Files in memory.
pub(super) struct Memory<'a>(pub(super) &'a [MemoryFile<'a>]);

impl Source for Memory<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.0.iter().any(|file| file.name == path)
    }

    fn load(&self, path: &Path, check: CheckStart) -> Result<Cow<'_, [u8]>, MeshError> {
        let missing = || FileError::read(path, io::ErrorKind::NotFound.into());
        let file = self.0.iter().find(|file| file.name == path).ok_or_else(missing)?;
        let start = &file.bytes[..file.bytes.len().min(START as usize)];
        check(start, Some(file.bytes.len() as u64)).map_err(|fault| fault.in_file(path))?;
        Ok(file.bytes.into())
    }
}
