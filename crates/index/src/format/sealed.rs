//! Finished index files: a database, checksums of its blocks, and a footer.
//!
//! | part | bytes | content |
//! |---|---|---|
//! | database | `n` | redb's pages |
//! | mark | 24 | magic: 12; `n`: u64; CRC-32 of both: u32 |
//! | checksums | `4 b` | CRC-32 of each of the `b` blocks of 4096 bytes of the database, the last perhaps shorter |
//! | footer | 40 | `n`: u64; CRC-32 of the checksums: u32; block size: u32; format version: u32; CRC-32 of the footer without this field: u32; magic: 16 |
//!
//! All numbers are little-endian. Checksums cover every byte of the file, and each block is checked when it is read,
//! so a changed byte never becomes a result. A finished file is never written again.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::IndexError;

/// Version of the file format.
pub const FORMAT_VERSION: u32 = 1;

/// Bytes under one checksum: the size of redb's pages, so that reading a page checks exactly that page.
pub(crate) const BLOCK: usize = 4096;

const MAGIC: [u8; 16] = *b"canonform index\n";
const FOOTER: u64 = 40;
/// Marks the end of the database; lets an interrupted [`seal`] be undone.
const MARK_MAGIC: [u8; 12] = *b"canonform ->";
const MARK: u64 = 24;
/// The first bytes of a redb file.
pub(crate) const DATABASE_MAGIC: [u8; 4] = *b"redb";

/// The last bytes of a finished file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Footer {
    database: u64,
    table_sum: u32,
}

impl Footer {
    fn to_bytes(self) -> Vec<u8> {
        let mut bytes = self.database.to_le_bytes().to_vec();
        bytes.extend(self.table_sum.to_le_bytes());
        bytes.extend((BLOCK as u32).to_le_bytes());
        bytes.extend(FORMAT_VERSION.to_le_bytes());
        bytes.extend(footer_sum(&bytes).to_le_bytes());
        bytes.extend(MAGIC);
        bytes
    }

    /// Reads the footer of a file; `None` if it has none.
    fn read(file: &mut File, path: &Path) -> Result<Option<Self>, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let length = file.seek(SeekFrom::End(0)).map_err(cannot_read)?;
        let Some(start) = length.checked_sub(FOOTER) else { return Ok(None) };
        let mut bytes = [0; FOOTER as usize];
        file.seek(SeekFrom::Start(start)).and_then(|_| file.read_exact(&mut bytes)).map_err(cannot_read)?;
        let number = |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
        if bytes[24..] != MAGIC {
            return Ok(None);
        }
        let version = number(16);
        let is_intact = footer_sum(&bytes[..20]) == number(20);
        if version > FORMAT_VERSION && is_intact {
            let (path, supported) = (path.to_owned(), FORMAT_VERSION);
            return Err(IndexError::FutureVersion { path, found: version, supported });
        }
        let database = u64::from(number(0)) | u64::from(number(4)) << 32;
        let table = 4 * database.div_ceil(BLOCK as u64);
        if !is_intact || database > length || database + MARK + table + FOOTER != length {
            return Err(IndexError::damaged(path, "its footer changed, or bytes before it are missing"));
        }
        Ok(Some(Self { database, table_sum: number(8) }))
    }

    /// A number that changes with the content of the file.
    pub(crate) fn fingerprint(self) -> u64 {
        self.database << 32 ^ u64::from(self.table_sum)
    }
}

fn footer_sum(bytes: &[u8]) -> u32 {
    let mut sum = crc32fast::Hasher::new();
    sum.update(bytes);
    sum.update(&MAGIC);
    sum.finalize()
}

/// Appends checksums and footer to a database that is not open, and flushes the file to disk.
pub(crate) fn seal(file: &mut File) -> io::Result<()> {
    let database = file.seek(SeekFrom::End(0))?;
    if !database.is_multiple_of(BLOCK as u64) {
        return Err(io::Error::other(format!("a database of {database} bytes does not end with a page")));
    }
    file.seek(SeekFrom::Start(0))?;
    let mut table = Vec::new();
    let mut block = Vec::with_capacity(BLOCK);
    let mut reader = BufReader::with_capacity(1 << 20, &mut *file);
    loop {
        block.clear();
        (&mut reader).take(BLOCK as u64).read_to_end(&mut block)?;
        if block.is_empty() {
            break;
        }
        table.extend(crc32fast::hash(&block).to_le_bytes());
    }
    drop(reader);
    let footer = Footer { database, table_sum: crc32fast::hash(&table) };
    file.seek(SeekFrom::Start(database))?;
    let mut out = BufWriter::new(&mut *file);
    out.write_all(&mark(database))?;
    out.write_all(&table)?;
    out.write_all(&footer.to_bytes())?;
    out.flush()?;
    drop(out);
    file.sync_all()
}

fn mark(database: u64) -> Vec<u8> {
    let mut bytes = [MARK_MAGIC.as_slice(), &database.to_le_bytes()].concat();
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes
}

/// Removes what [`seal`] appended, all of it or, after an interruption, a part.
pub(crate) fn unseal(file: &mut File) -> io::Result<()> {
    let length = file.seek(SeekFrom::End(0))?;
    let block = BLOCK as u64;
    // A database is a whole number of blocks, so bytes after the last whole block do not belong to it.
    let mut end = length - length % block;
    let least = end.saturating_sub(4 * length.div_ceil(block) + MARK + FOOTER);
    let mut found = [0; MARK as usize];
    let mut at = end;
    while at >= least.max(1) {
        if at + MARK <= length {
            file.seek(SeekFrom::Start(at))?;
            file.read_exact(&mut found)?;
            if found[..] == mark(at) {
                end = at;
                break;
            }
        }
        at -= block;
    }
    if end < length { file.set_len(end) } else { Ok(()) }
}

/// The database of a finished file. Checks each block as it is read.
#[derive(Debug)]
pub(crate) struct Sealed {
    file: Mutex<File>,
    pub(crate) footer: Footer,
    sums: Vec<u8>,
}

impl Sealed {
    /// # Errors
    /// [`IndexError::Foreign`], [`IndexError::FutureVersion`], [`IndexError::Damaged`], [`IndexError::Io`].
    pub(crate) fn open(path: &Path) -> Result<Self, IndexError> {
        let cannot_read = IndexError::io("read", path);
        let mut file = File::open(path).map_err(cannot_read)?;
        if !file.metadata().map_err(cannot_read)?.is_file() {
            return Err(IndexError::Foreign(path.to_owned()));
        }
        let Some(footer) = Footer::read(&mut file, path)? else {
            let mut head = Vec::new();
            file.seek(SeekFrom::Start(0)).map_err(cannot_read)?;
            Read::by_ref(&mut file).take(4).read_to_end(&mut head).map_err(cannot_read)?;
            return Err(match head == DATABASE_MAGIC {
                true => IndexError::damaged(path, "its footer is missing"),
                false => IndexError::Foreign(path.to_owned()),
            });
        };
        let mut sums = vec![0; 4 * footer.database.div_ceil(BLOCK as u64) as usize];
        let mut head = [0; MARK as usize];
        file.seek(SeekFrom::Start(footer.database)).map_err(cannot_read)?;
        file.read_exact(&mut head).map_err(cannot_read)?;
        file.read_exact(&mut sums).map_err(cannot_read)?;
        if crc32fast::hash(&sums) != footer.table_sum || head[..] != mark(footer.database) {
            return Err(IndexError::damaged(path, "its checksums changed"));
        }
        Ok(Self { file: Mutex::new(file), footer, sums })
    }

    /// Size of the database in bytes.
    pub(crate) fn len(&self) -> u64 {
        self.footer.database
    }

    /// Checks all blocks. Calls `done` after each mebibyte.
    ///
    /// # Errors
    /// An [`io::Error`] that names the first block that changed.
    pub(crate) fn check(&self, mut done: impl FnMut()) -> io::Result<()> {
        let mut buffer = vec![0; 1 << 20];
        let mut at = 0;
        while at < self.len() {
            let take = (self.len() - at).min(buffer.len() as u64) as usize;
            self.read(at, &mut buffer[..take])?;
            at += take as u64;
            done();
        }
        Ok(())
    }

    /// Reads whole blocks.
    pub(crate) fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        {
            let mut file = lock(&self.file);
            file.seek(SeekFrom::Start(offset))?;
            file.read_exact(out)?;
        }
        let first = offset as usize / BLOCK;
        for (i, block) in out.chunks(BLOCK).enumerate() {
            let known = self.sums.get(4 * (first + i)..4 * (first + i) + 4);
            if known != Some(crc32fast::hash(block).to_le_bytes().as_slice()) {
                let (start, end) = ((first + i) * BLOCK, (first + i + 1) * BLOCK - 1);
                let what = format!("bytes {start} to {end} changed");
                return Err(io::Error::new(io::ErrorKind::InvalidData, what));
            }
        }
        Ok(())
    }
}

pub(crate) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
