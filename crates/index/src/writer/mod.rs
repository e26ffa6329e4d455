//! Building and changing an index.

mod work;

use std::fs::{self, File};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use redb::Database;

use self::work::{Begun, copy_database, database, is_database, open_exclusively, with_suffix};
use crate::format::{ENTRIES, Guarded, Store, call, seal, unseal, write_cells};
use crate::{Index, IndexError, Shape, ShapeEntry};

pub use self::work::work_path;

/// The job of a writer. An interrupted job can be resumed by the same kind of job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Job {
    /// Index a whole collection.
    Build,
    /// Add shapes to an index.
    Add,
    /// Remove shapes from an index.
    Remove,
    /// Join several indexes.
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

    /// Whether it determines the whole content, so that a damaged index does not matter.
    fn starts_over(self) -> bool {
        matches!(self, Self::Build | Self::Merge)
    }

    /// Whether the work of an interrupted job of this name is worth keeping.
    fn resumes(name: &str) -> bool {
        [Self::Build, Self::Add].iter().any(|job| job.name() == name)
    }
}

/// The only writer of an index.
///
/// It works in a file next to the index, `NAME.work`, which replaces the index when the job is finished. Until then
/// readers see the old state. Shapes are on disk when [`put`](Self::put) returns. An interrupted writer leaves its
/// work file, and the next writer resumes it. All methods may return [`IndexError::Io`] and [`IndexError::Damaged`].
///
/// ```
/// use canonform_index::{IndexWriter, Job};
///
/// # let folder = tempfile::tempdir().unwrap();
/// # let path = folder.path().join("index");
/// drop(IndexWriter::open(&path, Job::Build, Some("options"))?); // interrupted
///
/// let writer = IndexWriter::open(&path, Job::Build, Some("options"))?;
/// assert!(writer.is_resumed());
/// assert!(writer.finish()?.is_empty());
/// # Ok::<(), canonform_index::IndexError>(())
/// ```
#[derive(Debug)]
pub struct IndexWriter {
    path: PathBuf,
    work: PathBuf,
    /// Locked as long as it is open.
    file: File,
    database: Guarded<Database>,
    /// Length of the vectors, once there is one.
    length: Option<usize>,
    resumed: bool,
    /// Whether the file that it will replace is damaged.
    replaces_damaged: bool,
}

impl IndexWriter {
    /// Starts to write an index, or resumes an interrupted job.
    ///
    /// `options` are the options that its shapes are described with; `None` takes them from the existing index. A build
    /// or a merge starts from nothing if the existing index is damaged, and keeps that file as `NAME.damaged`.
    ///
    /// # Errors
    /// [`IndexError::Busy`], [`IndexError::Unfinished`], [`IndexError::OtherOptions`] and those of [`Index::open`].
    pub fn open(path: &Path, job: Job, options: Option<&str>) -> Result<Self, IndexError> {
        let work = work_path(path);
        let (base, replaces_damaged) = match Index::open(path) {
            Ok(base) => (Some(base), false),
            Err(IndexError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => (None, false),
            Err(IndexError::Damaged { .. }) if job.starts_over() => (None, true),
            Err(error) => return Err(error),
        };
        let options = match (options, &base) {
            (Some(requested), Some(base)) => base.expect_options(requested).map(|()| requested.to_owned())?,
            (Some(requested), None) => requested.to_owned(),
            (None, Some(base)) => base.options().to_owned(),
            (None, None) => return Err(IndexError::io("read", path)(ErrorKind::NotFound.into())),
        };
        let cannot_write = IndexError::io("write", &work);
        let mut file = open_exclusively(path, &work)?;
        unseal(&mut file).map_err(cannot_write)?;
        let begun = Begun {
            job: job.name().to_owned(),
            options,
            base: base.as_ref().map_or(0, |index| index.fingerprint),
        };
        let new = |file: File, database: Guarded<Database>, length, resumed| {
            let (path, work) = (path.to_owned(), work.clone());
            Self { path, work, file, database, length, resumed, replaces_damaged }
        };
        match resume(&mut file, &work, job, &begun) {
            Ok(Some((database, length))) => return Ok(new(file, database, length, true)),
            // Work that cannot be read is of no use.
            Ok(None) | Err(IndexError::Damaged { .. }) => {}
            Err(error) => return Err(error),
        }
        // A merge starts empty.
        let base = base.filter(|_| job != Job::Merge);
        copy_database(&mut file, base.as_ref()).map_err(|error| match error.kind() {
            ErrorKind::InvalidData => IndexError::damaged(path, error.to_string()),
            _ => cannot_write(error),
        })?;
        let database = database(&file, &work)?;
        let store = Store { database: &database, path: &work, action: "write", n_bytes: n_bytes(&file) };
        begun.write(&store)?;
        let length = store.read()?.about("length")?;
        Ok(new(file, database, length, false))
    }

    pub(crate) fn store(&self) -> Store<'_> {
        let n_bytes = n_bytes(&self.file);
        Store { database: &self.database, path: &self.work, action: "write", n_bytes }
    }

    /// The index.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the existing index is damaged, so that the work started from nothing.
    #[must_use]
    pub fn replaces_damaged(&self) -> bool {
        self.replaces_damaged
    }

    /// Whether it resumes an interrupted job.
    #[must_use]
    pub fn is_resumed(&self) -> bool {
        self.resumed
    }

    /// Number of shapes so far.
    pub fn len(&self) -> Result<usize, IndexError> {
        self.store().read()?.len()
    }

    /// Whether there are no shapes so far.
    pub fn is_empty(&self) -> Result<bool, IndexError> {
        Ok(self.len()? == 0)
    }

    /// The entry of a shape, if it is there.
    pub fn entry(&self, id: &str) -> Result<Option<ShapeEntry>, IndexError> {
        self.store().read()?.entry(id)
    }

    /// The names and entries of all shapes so far, in ascending order of names.
    pub fn entries(&self) -> Result<Vec<(String, ShapeEntry)>, IndexError> {
        self.store().read()?.all(ENTRIES)
    }

    /// Stores shapes, replacing those of the same names. Either all of them are on disk when it returns, or none.
    ///
    /// # Errors
    /// [`IndexError::BadVector`], [`IndexError::OtherLength`], [`IndexError::Codec`].
    pub fn put(&mut self, shapes: &[Shape]) -> Result<(), IndexError> {
        let mut length = self.length;
        for shape in shapes {
            let fused = &shape.vectors.fused;
            if fused.is_empty() || !fused.iter().all(|x| x.is_finite()) {
                return Err(IndexError::BadVector(shape.id.clone()));
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

    /// Replaces entries of shapes and keeps their vectors.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`].
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

    /// Removes shapes.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`]; then no shape is removed.
    pub fn remove(&mut self, ids: &[String]) -> Result<(), IndexError> {
        let store = self.store();
        store.write(|transaction| {
            ids.iter().try_for_each(|id| match store.remove(transaction, id)? {
                true => Ok(()),
                false => Err(IndexError::NoSuchShape { path: self.path.clone(), id: id.clone() }),
            })
        })
    }

    /// Finishes the index and replaces the previous one.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then the index is unchanged, and the work is kept.
    pub fn finish(self) -> Result<Index, IndexError> {
        let store = self.store();
        write_cells(&store)?;
        let n_shapes = store.read()?.len()?;
        let Self { path, work, mut file, mut database, replaces_damaged, .. } = self;
        call(&work, "write", || database.compact())?;
        drop(database);
        // If this fails half-way, `unseal` removes the rest when the job is resumed.
        seal(&mut file).map_err(IndexError::io("write", &work))?;
        // redb does not report whether its last bytes were written, so check.
        let written = Index::open(&work)?;
        if written.len() != n_shapes {
            let what = format!("{} of {n_shapes} shapes were written", written.len());
            return Err(IndexError::damaged(&work, what));
        }
        if replaces_damaged {
            keep_damaged(&path)?;
        }
        let cannot_write = |error: files::FileError| IndexError::io("write", &path)(error.source);
        files::rename_durably(&work, &path).map_err(cannot_write)?;
        drop(file);
        Index::open(&path)
    }

    /// Discards the work. The index stays unchanged.
    pub fn discard(self) -> Result<(), IndexError> {
        let Self { work, database, .. } = self;
        drop(database);
        fs::remove_file(&work).map_err(IndexError::io("remove", &work))
    }
}

/// The database of an interrupted job and the length of its vectors, if it is known.
type Resumed = (Guarded<Database>, Option<usize>);

/// What an interrupted job left, if `begun` continues that job.
fn resume(file: &mut File, work: &Path, job: Job, begun: &Begun) -> Result<Option<Resumed>, IndexError> {
    if !is_database(file).map_err(IndexError::io("write", work))? {
        return Ok(None);
    }
    let database = database(file, work)?;
    let store = Store { database: &database, path: work, action: "write", n_bytes: n_bytes(file) };
    let Some(known) = Begun::read(&store)? else { return Ok(None) };
    // A work file that names another base is a copy of the index, made by a writer that was interrupted before it
    // recorded its job, or belongs to an earlier state of the index. A build determines the whole content, so it
    // continues all the same.
    let is_build = job == Job::Build && known.job == job.name();
    if !Job::resumes(&known.job) || known.base != begun.base && !is_build {
        return Ok(None);
    }
    if known.job != begun.job {
        return Err(IndexError::Unfinished { job: known.job, work: work.to_owned() });
    }
    if known.options != begun.options {
        let (found, requested) = (known.options, begun.options.clone());
        return Err(IndexError::OtherOptions { path: work.to_owned(), found, requested });
    }
    let length = store.read()?.about("length")?;
    Ok(Some((database, length)))
}

/// The size of an open file; 0 if it is unknown.
fn n_bytes(file: &File) -> u64 {
    file.metadata().map_or(0, |about| about.len())
}

/// Gives a damaged index a second name before the first one is taken.
fn keep_damaged(path: &Path) -> Result<(), IndexError> {
    let kept = damaged_path(path);
    let cannot_write = IndexError::io("write", &kept);
    match fs::remove_file(&kept) {
        Err(error) if error.kind() != ErrorKind::NotFound => return Err(cannot_write(error)),
        _ => {}
    }
    // Not every file system has links.
    fs::hard_link(path, &kept).or_else(|_| fs::copy(path, &kept).map(drop)).map_err(cannot_write)
}

/// The file that keeps a damaged index after it was built again.
#[must_use]
pub fn damaged_path(path: &Path) -> PathBuf {
    with_suffix(path, ".damaged")
}
