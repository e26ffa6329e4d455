//! Where the bytes of a mesh come from: the disk, memory, or whatever a program stores meshes in.

use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, Read};
use std::path::Path;

use base::files::FileError;
use flate2::bufread::GzDecoder;

use crate::located::{At, Located};
use mesh::{Fault, MeshError};

/// Checks the first bytes of a file, given its size if that is known: whether the whole can be a file of the format.
pub(crate) type Check<'a> = &'a dyn Fn(&[u8], Option<u64>) -> Result<(), Located>;

/// Bytes that are checked before the rest of a file is read.
const START: u64 = 16 << 10;

/// Decompressed data of this size is read whatever the size of the file.
const ALWAYS: u64 = 64 << 20;
/// Larger data may be this many times the size of the file. Meshes as text compress by a factor of 3 to 30.
const MAX_RATIO: u64 = 256;

/// The most bytes that compressed data of `size` bytes may grow to.
pub fn inflated_limit(size: u64) -> u64 {
    ALWAYS.max(size.saturating_mul(MAX_RATIO))
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
pub struct Opened<'a> {
    /// Its bytes.
    pub stream: Box<dyn Read + 'a>,
    /// Their number, if that is known.
    pub size: Option<u64>,
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
            Ok(Opened { stream: Box::new(File::open(path)?), size })
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
pub(crate) struct Memory<'a>(pub(crate) &'a [MemoryFile<'a>]);

impl FileSource for Memory<'_> {
    fn holds(&self, path: &Path) -> bool {
        self.0.iter().any(|file| file.name == path)
    }

    fn open(&self, path: &Path) -> Result<Opened<'_>, MeshError> {
        let file = self.0.iter().find(|file| file.name == path);
        let file = file.ok_or_else(|| FileError::read(path, io::ErrorKind::NotFound.into()))?;
        Ok(Opened::of(file.bytes))
    }
}

impl<'a> Opened<'a> {
    /// A file with this content.
    pub fn of(content: impl AsRef<[u8]> + 'a) -> Self {
        let size = Some(content.as_ref().len() as u64);
        Self { stream: Box::new(io::Cursor::new(content)), size }
    }

    /// Reads all bytes of a file whose start passes a check, decompressed or not: at most `max_bytes` of a stream of unknown
    /// size.
    pub(crate) fn load(
        self,
        path: &Path,
        is_gzip: bool,
        check: Check<'_>,
        max_bytes: u64,
    ) -> Result<Vec<u8>, MeshError> {
        let Self { stream, size } = self;
        if !is_gzip {
            return read_checked(path, stream, check, size, max_bytes);
        }
        let limit = size.map_or(max_bytes, inflated_limit);
        read_checked(path, Box::new(GzipReader::new(stream)), check, None, limit)
            .map_err(|fault| damage(path, fault))
    }

    /// A stream of unknown length, and whether it begins like a gzip file.
    pub(crate) fn sniffed(path: &Path, stream: &'a mut dyn Read) -> Result<(Self, bool), MeshError> {
        const GZIP: [u8; 2] = [0x1f, 0x8b];
        let mut start = Vec::new();
        stream.take(2).read_to_end(&mut start).map_err(|fault| FileError::read(path, fault))?;
        let is_gzip = start == GZIP;
        Ok((Self { stream: Box::new(io::Cursor::new(start).chain(stream)), size: None }, is_gzip))
    }
}

/// What is wrong with compressed data is not the fault of the system.
fn damage(path: &Path, fault: MeshError) -> MeshError {
    use io::ErrorKind::{InvalidData, InvalidInput, UnexpectedEof};
    let fault = match fault {
        MeshError::Io(fault) if matches!(fault.source.kind(), InvalidInput | InvalidData | UnexpectedEof) => {
            Fault::syntax("compressed data", fault.source)
        }
        MeshError::File { fault: Fault::OverLimit { items: "bytes", limit }, .. } => {
            Fault::decompression_bomb(limit)
        }
        other => return other,
    };
    fault.whole().in_file(path)
}

/// Reads a stream of `size` bytes, if that is known. Nothing is read beyond a start that fails the check, and at most
/// `max_bytes`.
fn read_checked(
    path: &Path,
    mut stream: Box<dyn Read + '_>,
    check: Check<'_>,
    size: Option<u64>,
    max_bytes: u64,
) -> Result<Vec<u8>, MeshError> {
    let cannot_read = |source| FileError::read(path, source);
    let mut bytes = Vec::new();
    stream.by_ref().take(START).read_to_end(&mut bytes).map_err(cannot_read)?;
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

/// Decompresses all members of a stream. Zeros behind them are ignored, as `gzip` does: tapes and some copies are filled up.
#[derive(Debug)]
pub struct GzipReader<R> {
    /// `None` after the last one.
    member: Option<GzDecoder<BufReader<R>>>,
}

impl<R: Read> GzipReader<R> {
    /// Begins with the first member.
    pub fn new(stream: R) -> Self {
        Self { member: Some(GzDecoder::new(BufReader::new(stream))) }
    }
}

impl<R: Read> Read for GzipReader<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while let Some(mut member) = self.member.take() {
            let n = member.read(buffer)?;
            if n > 0 || buffer.is_empty() {
                self.member = Some(member);
                return Ok(n);
            }
            let mut rest = member.into_inner();
            while rest.fill_buf()?.first() == Some(&0) {
                rest.consume(1);
            }
            if !rest.fill_buf()?.is_empty() {
                self.member = Some(GzDecoder::new(rest));
            }
        }
        Ok(0)
    }
}
