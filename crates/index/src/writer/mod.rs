//! Building and changing an index.

mod work;

use std::fs::{self, File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use redb::{Database, WriteTransaction};

use self::work::{Begun, open_exclusively, with_suffix};
use crate::format::{
    CellState, Changes, ENTRIES, Graph, Guarded, Sealed, Store, WorkFile, call, refresh_cells,
};
use crate::progress::Progress;
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
/// It works in a file next to the index, `NAME.work`, which holds what is new. When the job is finished, that is appended
/// to the index, or, if it is much, the index is written anew. Until then readers see the old state. Shapes are on disk
/// when [`put`](Self::put) returns. An interrupted writer leaves its work file, and the next writer resumes it. All
/// methods may return [`IndexError::Io`] and [`IndexError::Damaged`].
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
    lock: File,
    file: WorkFile,
    database: Guarded<Database>,
    /// The index as it was when the job began.
    base: Option<Index>,
    cells: CellState,
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
        let opened = || match Index::open(path) {
            Ok(base) => Ok((Some(base), false)),
            Err(IndexError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => Ok((None, false)),
            Err(IndexError::Damaged { .. }) if job.starts_over() => Ok((None, true)),
            Err(error) => Err(error),
        };
        let options_of = |base: Option<&Index>| match (options, base) {
            (Some(requested), Some(base)) => base.expect_options(requested).map(|()| requested.to_owned()),
            (Some(requested), None) => Ok(requested.to_owned()),
            (None, Some(base)) => Ok(base.options().to_owned()),
            (None, None) => Err(IndexError::io("read", path)(ErrorKind::NotFound.into())),
        };
        options_of(opened()?.0.as_ref())?;
        let lock = open_exclusively(path, &work)?;
        // Another writer may have finished before the file was locked.
        let (base, replaces_damaged) = opened()?;
        let options = options_of(base.as_ref())?;
        let begun =
            Begun { job: job.name().to_owned(), options, base: base.as_ref().map_or(0, Index::fingerprint) };
        let (file, database, resumed) = match resume(&lock, &work, job, &begun, base.as_ref()) {
            Ok(Some((file, database))) => (file, database, true),
            // Work that cannot be read is of no use.
            Ok(None) | Err(IndexError::Damaged { .. }) => {
                // A merge starts empty.
                let source = base.as_ref().filter(|_| job != Job::Merge);
                let begin = || WorkFile::begin(lock.try_clone()?, source.map(|base| base.sealed.clone()));
                let file = begin().map_err(IndexError::io("write", &work))?;
                let database = file.database(&work)?;
                let cells = if source.is_some() { CellState::Follow } else { CellState::Stale };
                begun.write(&store(&file, &database, &work), cells)?;
                (file, database, false)
            }
            Err(error) => return Err(error),
        };
        let about = store(&file, &database, &work);
        let about = about.read()?;
        let (length, cells) = (about.about("length")?, about.about("cells")?.unwrap_or(CellState::Stale));
        drop(about);
        let path = path.to_owned();
        Ok(Self { path, work, lock, file, database, base, cells, length, resumed, replaces_damaged })
    }

    pub(crate) fn store(&self) -> Store<'_> {
        store(&self.file, &self.database, &self.work)
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
        self.change(|store, transaction, changes| {
            if let Some(length) = length {
                store.set(transaction, "length", &length)?;
            }
            shapes.iter().try_for_each(|shape| store.put(transaction, shape, changes))
        })?;
        self.length = length;
        Ok(())
    }

    /// Changes shapes in one transaction.
    fn change(
        &mut self,
        change: impl FnOnce(&Store<'_>, &WriteTransaction, &mut Changes) -> Result<(), IndexError>,
    ) -> Result<(), IndexError> {
        let (store, mut changes) = (self.store(), Changes::new(self.cells));
        store.write(|transaction| {
            change(&store, transaction, &mut changes)?;
            store.end_changes(transaction, &changes)
        })?;
        if self.cells == CellState::Current {
            self.cells = CellState::Stale;
        }
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
        self.change(|store, transaction, changes| {
            entries.iter().try_for_each(|(id, entry)| store.put_entry(transaction, id, entry, changes))
        })
    }

    /// Removes shapes.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`]; then no shape is removed.
    pub fn remove(&mut self, ids: &[String]) -> Result<(), IndexError> {
        let path = self.path.clone();
        self.change(|store, transaction, changes| {
            ids.iter().try_for_each(|id| match store.remove(transaction, id, changes)? {
                true => Ok(()),
                false => Err(IndexError::NoSuchShape { path: path.clone(), id: id.clone() }),
            })
        })
    }

    /// Brings the cells and the graph up to date with the shapes.
    pub(crate) fn refresh(&self, progress: &dyn Progress) -> Result<(), IndexError> {
        refresh_cells(&self.store(), self.base.as_ref().map(Index::store).as_ref(), progress)
    }

    /// Whether the index has a graph of nearest neighbours, which earlier versions did not write.
    /// [`finish`](Self::finish) adds it.
    pub fn has_graph(&self) -> Result<bool, IndexError> {
        Ok(Graph::open(&self.store().read()?)?.is_some())
    }

    /// Finishes the index: appends what is new to it, or replaces it.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then the index is unchanged, and the work is kept.
    pub fn finish(self) -> Result<Index, IndexError> {
        self.finish_with(&())
    }

    /// As [`finish`](Self::finish), with reports of its progress: for a large index, finding the neighbours of all shapes
    /// takes minutes.
    ///
    /// # Errors
    /// Those of [`finish`](Self::finish).
    pub fn finish_with(self, progress: &dyn Progress) -> Result<Index, IndexError> {
        self.refresh(progress)?;
        let n_shapes = self.store().read()?.len()?;
        let Self { path, work, lock, mut file, database, base, replaces_damaged, .. } = self;
        drop(database);
        let cannot_write = IndexError::io("write", &work);
        if let Some(base) = base
            && let Some(mut target) = appendable(&path, &base.sealed)
            && let Some(room) = base.sealed.room()
            && let Some(changed) = file.changed(&base.sealed, room).map_err(cannot_write)?
        {
            append(&path, &mut target, &file, &changed, &base.sealed, n_shapes)?;
            fs::remove_file(&work).map_err(IndexError::io("remove", &work))?;
        } else {
            file.fill().map_err(cannot_write)?;
            let mut database = file.database(&work)?;
            call(&work, "write", || database.compact())?;
            drop(database);
            file.seal().map_err(cannot_write)?;
            expect(&Index::open(&work)?, n_shapes)?;
            if replaces_damaged {
                keep_damaged(&path)?;
            }
            let cannot_write = |error: files::FileError| IndexError::io("write", &path)(error.source);
            files::rename_durably(&work, &path).map_err(cannot_write)?;
        }
        drop((file, lock));
        Index::open(&path)
    }

    /// Bytes in the work file, without holes.
    #[cfg(all(test, unix))]
    pub(crate) fn n_written(&self) -> Result<u64, IndexError> {
        use std::os::unix::fs::MetadataExt;
        let about = self.lock.metadata().map_err(IndexError::io("read", &self.work))?;
        Ok(512 * about.blocks())
    }

    /// Discards the work. The index stays unchanged.
    pub fn discard(self) -> Result<(), IndexError> {
        let Self { work, database, .. } = self;
        drop(database);
        fs::remove_file(&work).map_err(IndexError::io("remove", &work))
    }
}

/// The file of an index, if a change may be appended to it: it is still the one that the job began with, may be written
/// and has no other name.
fn appendable(path: &Path, base: &Sealed) -> Option<File> {
    let file = OpenOptions::new().read(true).write(true).open(path).ok()?;
    let is_base = Sealed::open(path).is_ok_and(|sealed| sealed.fingerprint() == base.fingerprint());
    (is_base && files::is_at(&file, path) && !files::has_other_names(&file)).then_some(file)
}

/// Appends changed blocks to an index.
fn append(
    path: &Path,
    file: &mut File,
    work: &WorkFile,
    changed: &[u64],
    base: &Sealed,
    n_shapes: usize,
) -> Result<(), IndexError> {
    let cannot_write = IndexError::io("write", path);
    let state = work.append(changed, base, file).map_err(cannot_write)?;
    expect(&Index::of(path, Sealed::open_state(path, state)?)?, n_shapes)?;
    state.commit(file).map_err(cannot_write)
}

/// redb does not report whether its last bytes were written, so this checks it.
fn expect(written: &Index, n_shapes: usize) -> Result<(), IndexError> {
    match written.len() == n_shapes {
        true => Ok(()),
        false => {
            let what = format!("{} of {n_shapes} shapes were written", written.len());
            Err(IndexError::damaged(written.path(), what))
        }
    }
}

/// What an interrupted job left, if `begun` continues that job.
fn resume(
    lock: &File,
    work: &Path,
    job: Job,
    begun: &Begun,
    base: Option<&Index>,
) -> Result<Option<(WorkFile, Guarded<Database>)>, IndexError> {
    let sealed = base.map(|base| &base.sealed);
    let Some(file) = WorkFile::resume(lock, work, sealed)? else { return Ok(None) };
    let database = file.database(work)?;
    let Some(known) = Begun::read(&store(&file, &database, work))? else { return Ok(None) };
    // A work file that names another base is a copy of an index, or belongs to an earlier state of the index. A build
    // determines the whole content, so it continues all the same.
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
    Ok(Some((file, database)))
}

fn store<'a>(file: &WorkFile, database: &'a Guarded<Database>, work: &'a Path) -> Store<'a> {
    Store { database, path: work, action: "write", n_bytes: file.n_bytes() }
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
