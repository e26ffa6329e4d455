//! Making and changing an index.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use redb::backends::FileBackend;
use redb::{Database, StorageBackend};

use super::sealed::{BLOCK, DATABASE_MAGIC, Sealed, seal, unseal};
use super::tables::{CACHE, ENTRIES, Store, fault_at};
use super::{Index, IndexError, Shape, ShapeEntry};

/// What a writer is for; an interrupted one is taken up again by the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Job {
    /// Making the index of a whole collection.
    Build,
    /// Adding to an index.
    Add,
    /// Taking away from an index.
    Remove,
    /// Joining indexes.
    Merge,
}

impl Job {
    /// Its name in files and messages.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Build => "build",
            Self::Add => "add",
            Self::Remove => "remove",
            Self::Merge => "merge",
        }
    }

    /// Whether what was done before an interruption is worth keeping.
    fn resumes(name: &str) -> bool {
        [Self::Build, Self::Add].iter().any(|job| job.name() == name)
    }
}

/// The one writer of an index.
///
/// It works in a file beside the index, `NAME.work`, which takes the place of the index when it is
/// finished: readers see the index as it was until then, and as it is from then on. Every
/// [`put`](Self::put) is on the disk when it returns. A writer that is killed leaves its work; the next
/// one goes on with it.
#[derive(Debug)]
pub struct IndexWriter {
    path: PathBuf,
    work: PathBuf,
    /// Open for as long as nobody else may write.
    file: File,
    database: Database,
    /// Length of the vectors, once there is one.
    length: Option<usize>,
    resumed: bool,
}

/// A work file that redb reads and writes; its lock is held by the writer.
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

/// Where a writer of this index works.
#[must_use]
pub fn work_path(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(".work");
    path.with_file_name(name)
}

impl IndexWriter {
    /// Begins to write an index, or goes on with what was interrupted.
    ///
    /// `options` says how its shapes are described; `None` takes it from the index, which must then be
    /// there.
    ///
    /// # Errors
    /// [`IndexError::Busy`], [`IndexError::Unfinished`], [`IndexError::OtherOptions`] and those of
    /// [`Index::open`].
    pub fn open(path: &Path, job: Job, options: Option<&str>) -> Result<Self, IndexError> {
        let work = work_path(path);
        let base = if path.exists() { Some(Index::open(path)?) } else { None };
        let options = match (options, &base) {
            (Some(asked), Some(base)) => base.expect_options(asked).map(|()| asked.to_owned())?,
            (Some(asked), None) => asked.to_owned(),
            (None, Some(base)) => base.options().to_owned(),
            (None, None) => {
                let source = io::ErrorKind::NotFound.into();
                return Err(IndexError::Io { action: "read", path: path.to_owned(), source });
            }
        };
        let cannot_write = |source| IndexError::Io { action: "write", path: work.clone(), source };
        let mut file = exclusive(path, &work)?;
        unseal(&mut file).map_err(cannot_write)?;
        let fingerprint = base.as_ref().map_or(0, Index::fingerprint);
        if is_database(&mut file).map_err(cannot_write)? {
            let database = database(&file, &work)?;
            let store = Store { database: &database, path: &work, action: "write" };
            let begun = Begun::read(&store)?;
            match begun.whole() {
                Some((known, its_options, its_base)) if Job::resumes(&known) => {
                    if known != job.name() {
                        return Err(IndexError::Unfinished { job: known, work });
                    }
                    if its_options != options {
                        return Err(IndexError::OtherOptions {
                            path: work,
                            found: its_options,
                            asked: options,
                        });
                    }
                    // What is added must be added to what is there now; a build says itself what is there.
                    if job == Job::Build || its_base == fingerprint {
                        let length = store.read()?.about("length")?;
                        let path = path.to_owned();
                        return Ok(Self { path, work, file, database, length, resumed: true });
                    }
                }
                _ => {}
            }
        }
        // What is joined begins with nothing.
        let base = base.filter(|_| job != Job::Merge);
        begin(&mut file, base.as_ref()).map_err(|fault| match fault.kind() {
            io::ErrorKind::InvalidData => {
                IndexError::Damaged { path: path.to_owned(), what: fault.to_string() }
            }
            _ => cannot_write(fault),
        })?;
        let database = database(&file, &work)?;
        let store = Store { database: &database, path: &work, action: "write" };
        store.write(|transaction| {
            store.set(transaction, "options", &options)?;
            store.set(transaction, "base", &fingerprint)?;
            store.set(transaction, "job", &job.name())
        })?;
        let length = store.read()?.about("length")?;
        Ok(Self { path: path.to_owned(), work, file, database, length, resumed: false })
    }

    fn store(&self) -> Store<'_> {
        Store { database: &self.database, path: &self.work, action: "write" }
    }

    /// Whether it goes on with what was interrupted.
    #[must_use]
    pub fn is_resumed(&self) -> bool {
        self.resumed
    }

    /// Number of shapes so far.
    ///
    /// # Errors
    /// [`IndexError::Io`], [`IndexError::Damaged`]; so for all that read or write below.
    pub fn len(&self) -> Result<usize, IndexError> {
        self.store().read()?.len()
    }

    /// Whether there is none.
    ///
    /// # Errors
    /// As [`len`](Self::len).
    pub fn is_empty(&self) -> Result<bool, IndexError> {
        Ok(self.len()? == 0)
    }

    /// What is known of a shape so far.
    ///
    /// # Errors
    /// As [`len`](Self::len).
    pub fn entry(&self, id: &str) -> Result<Option<ShapeEntry>, IndexError> {
        self.store().read()?.entry(id)
    }

    /// The names of all shapes so far, ascending.
    ///
    /// # Errors
    /// As [`len`](Self::len).
    pub fn ids(&self) -> Result<Vec<String>, IndexError> {
        self.store().read()?.keys(ENTRIES)
    }

    /// Stores shapes, each over the one of its name: all of them are on the disk when this returns, or
    /// none is.
    ///
    /// # Errors
    /// [`IndexError::BadVector`], [`IndexError::OtherLength`], [`IndexError::Codec`],
    /// [`IndexError::Io`].
    pub fn put(&mut self, shapes: &[Shape]) -> Result<(), IndexError> {
        let mut length = self.length;
        for shape in shapes {
            let fused = &shape.vectors.fused;
            if fused.is_empty() || !fused.iter().all(|x| x.is_finite()) {
                return Err(IndexError::BadVector { id: shape.id.clone() });
            }
            let expected = *length.get_or_insert(fused.len());
            if fused.len() != expected {
                return Err(IndexError::OtherLength { id: shape.id.clone(), found: fused.len(), expected });
            }
        }
        let store = self.store();
        store.write(|transaction| {
            if let Some(length) = length {
                store.set(transaction, "length", &length)?;
            }
            shapes.iter().try_for_each(|shape| store.put(transaction, shape))
        })?;
        self.length = length;
        Ok(())
    }

    /// Changes what is known of shapes whose vectors stay.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`], [`IndexError::Io`].
    pub fn set_entries(&mut self, entries: &[(String, ShapeEntry)]) -> Result<(), IndexError> {
        let store = self.store();
        let known = store.read()?;
        for (id, _) in entries {
            if known.entry(id)?.is_none() {
                return Err(IndexError::NoSuchShape { path: self.path.clone(), id: id.clone() });
            }
        }
        drop(known);
        store.write(|transaction| {
            entries.iter().try_for_each(|(id, entry)| store.put_entry(transaction, id, entry))
        })
    }

    /// Takes shapes away.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`]: then all of them stay; [`IndexError::Io`].
    pub fn remove(&mut self, ids: &[String]) -> Result<(), IndexError> {
        let store = self.store();
        store.write(|transaction| {
            ids.iter().try_for_each(|id| match store.remove(transaction, id)? {
                true => Ok(()),
                false => Err(IndexError::NoSuchShape { path: self.path.clone(), id: id.clone() }),
            })
        })
    }

    /// Puts the index into its place, over what was there.
    ///
    /// # Errors
    /// [`IndexError::Io`]: then the index is as it was, and the work is kept.
    pub fn finish(self) -> Result<Index, IndexError> {
        let Self { path, work, mut file, mut database, .. } = self;
        let cannot = |action, path: &Path| {
            let path = path.to_owned();
            move |source| IndexError::Io { action, path, source }
        };
        let store = Store { database: &database, path: &work, action: "write" };
        crate::search::write(&store)?;
        let n_shapes = store.read()?.len()?;
        database.compact().map_err(|fault| fault_at(&work, "write", fault))?;
        drop(database);
        // Whatever of it cannot be written is cut off when work goes on.
        seal(&mut file).map_err(cannot("write", &work))?;
        // redb has no say in whether its last bytes were written: look.
        let written = Index::open(&work)?;
        if written.len() != n_shapes {
            let what = format!("{} of {n_shapes} shapes were written", written.len());
            return Err(IndexError::Damaged { path: work, what });
        }
        fs::rename(&work, &path).map_err(cannot("write", &path))?;
        sync_folder(&path).map_err(cannot("write", &path))?;
        drop(file);
        Index::open(&path)
    }

    /// Gives up: the index stays as it was, and nothing is left of the work.
    ///
    /// # Errors
    /// [`IndexError::Io`].
    pub fn discard(self) -> Result<(), IndexError> {
        let Self { work, database, .. } = self;
        drop(database);
        fs::remove_file(&work).map_err(|source| IndexError::Io { action: "remove", path: work, source })
    }
}

/// What a work file says of itself.
struct Begun {
    job: Option<String>,
    options: Option<String>,
    base: Option<u64>,
}

impl Begun {
    fn read(store: &Store<'_>) -> Result<Self, IndexError> {
        let about = store.read()?;
        Ok(Self { job: about.about("job")?, options: about.about("options")?, base: about.about("base")? })
    }

    /// Unless it was interrupted before it said so.
    fn whole(self) -> Option<(String, String, u64)> {
        Some((self.job?, self.options?, self.base?))
    }
}

/// Opens the work file of an index so that nobody else does.
fn exclusive(path: &Path, work: &Path) -> Result<File, IndexError> {
    let cannot_write = |source| IndexError::Io { action: "write", path: work.to_owned(), source };
    loop {
        let file = OpenOptions::new()
            .read(true)
            .write(true)
            .create(true)
            .truncate(false)
            .open(work)
            .map_err(cannot_write)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(IndexError::Busy { path: path.to_owned() }),
            Err(TryLockError::Error(source)) => return Err(cannot_write(source)),
        }
        // Another writer may have put the file into its place between the two.
        if is_at(&file, work) {
            return Ok(file);
        }
    }
}

/// Whether an open file is still the one of this name.
#[cfg(unix)]
fn is_at(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => open.ino() == named.ino() && open.dev() == named.dev(),
        _ => false,
    }
}

/// Whether an open file is still the one of this name: an open file cannot be renamed here.
#[cfg(not(unix))]
fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

/// Whether a file begins as a database.
fn is_database(file: &mut File) -> io::Result<bool> {
    use std::io::Read;
    let mut head = Vec::new();
    file.seek(SeekFrom::Start(0))?;
    file.take(DATABASE_MAGIC.len() as u64).read_to_end(&mut head)?;
    Ok(head == DATABASE_MAGIC)
}

fn database(file: &File, work: &Path) -> Result<Database, IndexError> {
    let fault = |fault: redb::DatabaseError| fault_at(work, "write", fault);
    let file = file.try_clone().map_err(|source| IndexError::Io {
        action: "write",
        path: work.to_owned(),
        source,
    })?;
    let backend = Work(FileBackend::new(file).map_err(fault)?);
    Database::builder().set_cache_size(CACHE).create_with_backend(backend).map_err(fault)
}

/// Makes the file a copy of the database of `base`, or empty. Its first block comes last: an
/// interrupted copy is no database.
fn begin(file: &mut File, base: Option<&Index>) -> io::Result<()> {
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

/// Hands the new name of a file to the disk.
fn sync_folder(path: &Path) -> io::Result<()> {
    if cfg!(unix) {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}
