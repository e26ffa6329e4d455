//! Where the bytes of a mesh come from: the disk, memory, or whatever a program stores meshes in.

use std::borrow::Cow;
use std::fmt;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::Path;

use base::files::FileError;

use super::gzip::GzipReader;
use super::name;
use crate::located::{At, Located};
use mesh::{Fault, MeshError};

/// Checks the first bytes of a file, given its size if that is known: whether the whole can be a file of the format.
pub(super) type CheckStart = fn(&[u8], Option<u64>) -> Result<(), Located>;

/// Bytes that are checked before the rest of a file is read.
const START: u64 = 16 << 10;

/// Decompressed data of this size is read whatever the size of the file.
const ALWAYS: u64 = 64 << 20;
/// Larger data may be this many times the size of the file. Meshes as text compress by a factor of 3 to 30.
const MOST_RATIO: u64 = 256;

/// The most bytes that compressed data of `size` bytes may grow to.
#[must_use]
pub fn inflated_limit(size: u64) -> u64 {
    ALWAYS.max(size.saturating_mul(MOST_RATIO))
}

/// A file in memory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct MemoryFile<'a> {
    /// Its name. The extension determines the format; the rest only appears in messages.
    pub name: &'a Path,
    /// Its content.
    pub bytes: &'a [u8],
}

/// An opened file.
pub enum Opened<'a> {
    /// All of its bytes.
    Bytes(Cow<'a, [u8]>),
    /// A stream, and its number of bytes if that is known.
    Stream(Box<dyn Read + 'a>, Option<u64>),
}

impl fmt::Debug for Opened<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bytes(bytes) => write!(f, "{} bytes", bytes.len()),
            Self::Stream(_, size) => write!(f, "a stream of {size:?} bytes"),
        }
    }
}

/// A place that holds files: implement it to read meshes from a store of your own.
pub trait FileSource {
    /// Whether there is a file with this name.
    fn holds(&self, path: &Path) -> bool;

    /// Opens a file.
    ///
    /// # Errors
    /// If there is none, or if it cannot be read: [`MeshError::Io`] or [`MeshError::File`].
    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError>;
}

/// The regular files of the file system.
#[derive(Debug, Clone, Copy, Default)]
pub struct Disk;

impl FileSource for Disk {
    fn holds(&self, path: &Path) -> bool {
        path.exists()
    }

    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError> {
        let open = || {
            let facts = fs::metadata(path)?;
            if !facts.is_file() {
                return Err(io::Error::new(io::ErrorKind::InvalidInput, not_regular(&facts)));
            }
            // A file of unknown size, as some file systems have, has the size zero.
            let size = Some(facts.len()).filter(|size| *size > 0);
            Ok(Opened::Stream(Box::new(File::open(path)?), size))
        };
        open().map_err(|fault| FileError::read(path, fault).into())
    }
}

/// Says what kind of file cannot be read by its name.
fn not_regular(facts: &fs::Metadata) -> &'static str {
    match facts.is_dir() {
        true => "a folder is not a regular file",
        false => "a pipe or a device is not a regular file; pass its content through standard input",
    }
}

/// Files in memory.
pub(super) struct Memory<'a>(pub(super) &'a [MemoryFile<'a>]);

impl FileSource for Memory<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.0.iter().any(|file| file.name == path)
    }

    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError> {
        let file = self.0.iter().find(|file| file.name == path);
        let file = file.ok_or_else(|| FileError::read(path, io::ErrorKind::NotFound.into()))?;
        Ok(Opened::Bytes(file.bytes.into()))
    }
}

/// Reads a file whose start passes a check, and decompresses it if its name says so.
pub(super) fn load<'a>(
    source: &'a dyn FileSource,
    path: &Path,
    check: CheckStart,
) -> Result<Cow<'a, [u8]>, MeshError> {
    match (source.open(path)?, name::is_gzip(path)) {
        (Opened::Bytes(bytes), false) => {
            let start = &bytes[..bytes.len().min(START as usize)];
            check(start, Some(bytes.len() as u64)).map_err(|fault| fault.in_file(path))?;
            Ok(bytes)
        }
        (Opened::Bytes(bytes), true) => {
            let size = bytes.len() as u64;
            Ok(read_gzip(path, &mut &*bytes, check, inflated_limit(size))?.into())
        }
        (Opened::Stream(mut stream, size), false) => {
            Ok(read_checked(path, &mut stream, check, size, u64::MAX)?.into())
        }
        (Opened::Stream(mut stream, size), true) => {
            Ok(read_gzip(path, &mut stream, check, size.map_or(u64::MAX, inflated_limit))?.into())
        }
    }
}

/// Reads a stream of unknown length, at most `max_bytes`. It is decompressed if it begins like a gzip file.
pub(super) fn load_stream(
    path: &Path,
    stream: &mut dyn Read,
    check: CheckStart,
    max_bytes: u64,
) -> Result<Vec<u8>, MeshError> {
    const GZIP: [u8; 2] = [0x1f, 0x8b];
    let mut start = Vec::new();
    stream.take(2).read_to_end(&mut start).map_err(|fault| FileError::read(path, fault))?;
    let is_gzip = start == GZIP;
    let mut stream = start.chain(stream);
    match is_gzip {
        true => read_gzip(path, &mut stream, check, max_bytes),
        false => read_checked(path, &mut stream, check, None, max_bytes),
    }
}

fn read_gzip(
    path: &Path,
    stream: &mut dyn Read,
    check: CheckStart,
    limit: u64,
) -> Result<Vec<u8>, MeshError> {
    // What is wrong with compressed data is not the fault of the system.
    let is_damage = |kind| {
        matches!(
            kind,
            io::ErrorKind::InvalidInput | io::ErrorKind::InvalidData | io::ErrorKind::UnexpectedEof
        )
    };
    let fault = match read_checked(path, &mut GzipReader::new(stream), check, None, limit) {
        Err(MeshError::Io(fault)) if is_damage(fault.source.kind()) => {
            Fault::syntax("compressed data", fault.source.to_string())
        }
        Err(MeshError::File { fault: Fault::OverLimit { items: "bytes", limit }, .. }) => {
            Fault::Inflates { limit }
        }
        other => return other,
    };
    Err(fault.whole().in_file(path))
}

/// Reads a stream of `size` bytes, if that is known. Nothing is read beyond a start that fails the check, and at most
/// `max_bytes`.
fn read_checked(
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
        let room = size.unwrap_or(0).min(max_bytes).saturating_sub(START);
        let room = usize::try_from(room).unwrap_or(usize::MAX);
        bytes.try_reserve_exact(room).map_err(|_| cannot_read(io::ErrorKind::OutOfMemory.into()))?;
        // One byte more than is allowed shows that there are too many.
        let rest = max_bytes.saturating_add(1).saturating_sub(START);
        stream.take(rest).read_to_end(&mut bytes).map_err(cannot_read)?;
    }
    match bytes.len() as u64 > max_bytes {
        true => Err(Fault::OverLimit { items: "bytes", limit: max_bytes }.whole().in_file(path)),
        false => Ok(bytes),
    }
}
