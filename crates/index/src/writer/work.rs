//! The file that a writer works in, and what it records about an interrupted job.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use redb::backends::FileBackend;
use redb::{Database, StorageBackend};

use crate::format::{BLOCK, CACHE, DATABASE_MAGIC, Guarded, Sealed, Store, call};
use crate::{Index, IndexError};

/// The file that a writer of this index works in.
#[must_use]
pub fn work_path(path: &Path) -> PathBuf {
    with_suffix(path, ".work")
}

pub(super) fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(suffix);
    path.with_file_name(name)
}

/// What a work file records about its job.
pub(super) struct Begun {
    pub(super) job: String,
    pub(super) options: String,
    /// Fingerprint of the index that it is a copy of; 0 if there was none.
    pub(super) base: u64,
}

impl Begun {
    /// Returns `None` if the writer was interrupted before it recorded its job.
    pub(super) fn read(store: &Store<'_>) -> Result<Option<Self>, IndexError> {
        let about = store.read()?;
        let (job, options, base) = (about.about("job")?, about.about("options")?, about.about("base")?);
        Ok(match (job, options, base) {
            (Some(job), Some(options), Some(base)) => Some(Self { job, options, base }),
            _ => None,
        })
    }

    pub(super) fn write(&self, store: &Store<'_>) -> Result<(), IndexError> {
        store.write(|transaction| {
            store.set(transaction, "options", &self.options)?;
            store.set(transaction, "base", &self.base)?;
            store.set(transaction, "job", &self.job)
        })
    }
}

/// Opens the work file of an index and locks it against other writers.
pub(super) fn open_exclusively(path: &Path, work: &Path) -> Result<File, IndexError> {
    let cannot_write = IndexError::io("write", work);
    loop {
        let mut options = OpenOptions::new();
        let file =
            options.read(true).write(true).create(true).truncate(false).open(work).map_err(cannot_write)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(IndexError::Busy(path.to_owned())),
            Err(TryLockError::Error(source)) => return Err(cannot_write(source)),
        }
        // Another writer may have renamed the file before it was locked.
        if files::is_at(&file, work) {
            return Ok(file);
        }
    }
}

/// Whether a file begins like a database.
pub(super) fn is_database(file: &mut File) -> io::Result<bool> {
    let mut head = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.take(DATABASE_MAGIC.len() as u64).read_to_end(&mut head)?;
    Ok(head == DATABASE_MAGIC)
}

/// Opens a work file as a database.
pub(super) fn database(file: &File, work: &Path) -> Result<Guarded<Database>, IndexError> {
    let file = file.try_clone().map_err(IndexError::io("write", work))?;
    let database = call(work, "write", || {
        let backend = Work(FileBackend::new(file)?);
        Database::builder().set_cache_size(CACHE).create_with_backend(backend)
    })?;
    Ok(Guarded::new(database))
}

/// Makes a file a copy of the database of `base`, or empty. Writes the first block last, so that an interrupted copy
/// is not a database.
pub(super) fn copy_database(file: &mut File, base: Option<&Index>) -> io::Result<()> {
    file.set_len(0)?;
    let Some(base) = base else { return Ok(()) };
    let sealed = Sealed::open(base.path()).map_err(io::Error::other)?;
    let mut buffer = vec![0; 256 * BLOCK];
    let mut at = BLOCK as u64;
    file.seek(SeekFrom::Start(at))?;
    while at < sealed.len() {
        let part = &mut buffer[..(sealed.len() - at).min(256 * BLOCK as u64) as usize];
        sealed.read(at, part)?;
        file.write_all(part)?;
        at += part.len() as u64;
    }
    file.sync_data()?;
    let first = &mut buffer[..sealed.len().min(BLOCK as u64) as usize];
    sealed.read(0, first)?;
    file.seek(SeekFrom::Start(0))?;
    file.write_all(first)?;
    file.sync_data()
}

/// redb's file backend without its locks: the writer holds one already.
#[derive(Debug)]
struct Work(FileBackend);

impl StorageBackend for Work {
    fn len(&self) -> io::Result<u64> {
        self.0.len()
    }

    fn read(&self, offset: u64, out: &mut [u8]) -> io::Result<()> {
        self.0.read(offset, out)
    }

    fn set_len(&self, len: u64) -> io::Result<()> {
        self.0.set_len(len)
    }

    fn sync_data(&self) -> io::Result<()> {
        self.0.sync_data()
    }

    fn write(&self, offset: u64, data: &[u8]) -> io::Result<()> {
        self.0.write(offset, data)
    }
}
