//! Building and changing an index.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use base::Observer;
use serde::{Deserialize, Serialize};

use crate::derived::derived;
use crate::store::{Changes, Log, StoredFile, View, decode, encode};
use crate::tables::{ENTRIES, FUSED, put_shape, remove_shape};
use crate::{Index, IndexError, Shape, ShapeEntry};

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

    /// Whether it determines the whole content, so that an index that cannot be read does not matter.
    fn starts_over(self) -> bool {
        matches!(self, Self::Build | Self::Merge)
    }

    /// Whether the work of an interrupted job of this name is worth keeping.
    fn resumes(name: &str) -> bool {
        [Self::Build, Self::Add].iter().any(|job| job.name() == name)
    }
}

/// What a log records about its job.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Begun {
    job: String,
    options: String,
    /// Fingerprint of the index that it changes; 0 if there was none.
    base: u64,
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
/// assert!(writer.finish(&())?.is_empty());
/// # Ok::<(), canonform_index::IndexError>(())
/// ```
#[derive(Debug)]
pub struct IndexWriter {
    path: PathBuf,
    /// Its file is locked as long as it is open.
    log: Log,
    /// The index that the log changes; a merge changes none.
    base: Option<Index>,
    options: String,
    /// Length of the vectors, once there is one.
    length: Option<usize>,
    resumed: bool,
    /// Whether the file that it will replace cannot be read.
    replaces_damaged: bool,
}

impl IndexWriter {
    /// Starts to write an index, or resumes an interrupted job.
    ///
    /// `options` are the options that its shapes are described with; `None` takes them from the existing index. A build
    /// or a merge starts from nothing if the existing index is damaged or of a past version, and keeps that file as
    /// `NAME.damaged`.
    ///
    /// # Errors
    /// [`IndexError::Busy`], [`IndexError::Unfinished`], [`IndexError::OtherOptions`] and those of [`Index::open`].
    pub fn open(path: &Path, job: Job, options: Option<&str>) -> Result<Self, IndexError> {
        let work = work_path(path);
        let opened = || match Index::open(path) {
            Ok(base) => Ok((Some(base), false)),
            Err(IndexError::Io { source, .. }) if source.kind() == ErrorKind::NotFound => Ok((None, false)),
            Err(IndexError::Damaged { .. } | IndexError::PastVersion { .. }) if job.starts_over() => {
                Ok((None, true))
            }
            Err(error) => Err(error),
        };
        let options_of = |base: Option<&Index>| match (options, base) {
            (Some(requested), Some(base)) => base.expect_options(requested).map(|()| requested.to_owned()),
            (Some(requested), None) => Ok(requested.to_owned()),
            (None, Some(base)) => Ok(base.options().to_owned()),
            (None, None) => Err(IndexError::io("read", path)(ErrorKind::NotFound.into())),
        };
        options_of(opened()?.0.as_ref())?;
        let file = open_exclusively(path, &work)?;
        // Another writer may have finished before the file was locked.
        let (base, replaces_damaged) = opened()?;
        let options = options_of(base.as_ref())?;
        let fingerprint = base.as_ref().map_or(0, Index::fingerprint);
        let begun = Begun { job: job.name().to_owned(), options: options.clone(), base: fingerprint };
        let clone = || file.try_clone().map_err(IndexError::io("write", &work));
        let known = Log::resume(clone()?, &work)?;
        let (log, resumed) = match known.map_or(Ok(None), |log| resumed(log, job, &begun))? {
            Some(log) => (log, true),
            None => {
                let begun =
                    encode(&begun).map_err(|reason| IndexError::Codec { id: options.clone(), reason })?;
                (Log::begin(clone()?, &work, begun)?, false)
            }
        };
        let base = base.filter(|_| job != Job::Merge);
        let path = path.to_owned();
        let mut writer = Self { path, log, base, options, length: None, resumed, replaces_damaged };
        match writer.read_start() {
            Ok(()) => {}
            // Not every byte is checked when an index is opened.
            Err(IndexError::Damaged { .. }) if job.starts_over() => {
                (writer.base, writer.replaces_damaged) = (None, true);
                writer.read_start()?;
            }
            Err(fault) => {
                // A job that has not begun leaves nothing to resume, so that a damaged index can be built again.
                if !resumed {
                    writer.discard()?;
                }
                return Err(fault);
            }
        }
        Ok(writer)
    }

    /// Learns the length of the vectors so far, and whether the shapes can be counted.
    fn read_start(&mut self) -> Result<(), IndexError> {
        let first = FUSED.rows(self.view(), &[]).next().transpose()?;
        self.length = first.map(|(_, fused)| fused.0.len());
        self.n_shapes().map(drop)
    }

    fn view(&self) -> View<'_> {
        View::of_log(&self.log, self.base.as_ref().map(|base| &base.stored))
    }

    /// The index.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the existing index cannot be read, so that the work started from nothing.
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
    pub fn n_shapes(&self) -> Result<usize, IndexError> {
        let mut n_shapes = self.base.as_ref().map_or(0, Index::len);
        for (id, is_there) in ENTRIES.changed(self.view()) {
            let was_there = self.base.as_ref().map_or(Ok(false), |base| base.contains(&id))?;
            n_shapes = n_shapes + usize::from(is_there) - usize::from(was_there);
        }
        Ok(n_shapes)
    }

    /// The entry of a shape, if it is there.
    pub fn entry(&self, id: &str) -> Result<Option<ShapeEntry>, IndexError> {
        ENTRIES.get(self.view(), id)
    }

    /// The names and entries of all shapes so far, in ascending order of names.
    pub fn entries(&self) -> Result<Vec<(String, ShapeEntry)>, IndexError> {
        ENTRIES.rows(self.view(), &[]).collect()
    }

    /// Stores shapes, replacing those of the same names. Either all of them are on disk when it returns, or none.
    ///
    /// # Errors
    /// [`IndexError::BadVector`], [`IndexError::OtherLength`], [`IndexError::Codec`].
    pub fn put(&mut self, shapes: &[Shape]) -> Result<(), IndexError> {
        let (mut length, mut changes) = (self.length, Changes::new());
        for shape in shapes {
            let fused = &shape.vectors.fused;
            if fused.is_empty() || !fused.iter().all(|x| x.is_finite()) {
                return Err(IndexError::BadVector(shape.id.clone()));
            }
            let expected = *length.get_or_insert(fused.len());
            if fused.len() != expected {
                return Err(IndexError::OtherLength { id: shape.id.clone(), found: fused.len(), expected });
            }
            put_shape(&mut changes, shape)?;
        }
        self.log.append(&changes)?;
        self.length = length;
        Ok(())
    }

    /// Replaces entries of shapes and keeps their vectors.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`].
    pub fn set_entries(&mut self, entries: &[(String, ShapeEntry)]) -> Result<(), IndexError> {
        let mut changes = Changes::new();
        for (id, entry) in entries {
            self.expect(id)?;
            ENTRIES.put(&mut changes, id, Some(entry))?;
        }
        self.log.append(&changes)
    }

    /// Removes shapes.
    ///
    /// # Errors
    /// [`IndexError::NoSuchShape`]; then no shape is removed.
    pub fn remove(&mut self, ids: &[String]) -> Result<(), IndexError> {
        let mut changes = Changes::new();
        for id in ids {
            self.expect(id)?;
            remove_shape(&mut changes, id)?;
        }
        self.log.append(&changes)
    }

    fn expect(&self, id: &str) -> Result<(), IndexError> {
        match self.entry(id)? {
            Some(_) => Ok(()),
            None => Err(IndexError::NoSuchShape { path: self.path.clone(), id: id.to_owned() }),
        }
    }

    /// Finishes the index: appends what is new to it, or replaces it.
    ///
    /// # Errors
    /// [`IndexError::Io`]; then the index is unchanged, and the work is kept.
    pub fn finish(self, observer: &dyn Observer) -> Result<Index, IndexError> {
        observer.begin("counting classes", 0);
        let view = self.view();
        let changes = derived(view, &self.options)?;
        if !view.append(&changes)? {
            if self.replaces_damaged {
                keep_damaged(&self.path)?;
            }
            StoredFile::write(&self.path, view.records_with(&changes))?;
        }
        let index = Index::open(&self.path)?;
        self.discard()?;
        Ok(index)
    }

    /// Discards the work. The index stays unchanged.
    pub fn discard(self) -> Result<(), IndexError> {
        let work = self.log.path();
        fs::remove_file(work).map_err(IndexError::io("remove", work))
    }
}

/// The log of an interrupted job, if `begun` continues that job.
fn resumed(log: Log, job: Job, begun: &Begun) -> Result<Option<Log>, IndexError> {
    let Ok(known) = decode::<Begun>(log.job()) else { return Ok(None) };
    // Work on an earlier state of the index is of no use. A build determines the whole content, so it continues all the
    // same.
    let is_build = job == Job::Build && known.job == job.name();
    if !Job::resumes(&known.job) || known.base != begun.base && !is_build {
        return Ok(None);
    }
    if known.job != begun.job {
        return Err(IndexError::Unfinished { job: known.job, work: log.path().to_owned() });
    }
    if known.options != begun.options {
        let (found, requested) = (known.options, begun.options.clone());
        return Err(IndexError::OtherOptions { path: log.path().to_owned(), found, requested });
    }
    Ok(Some(log))
}

/// Opens the work file of an index and locks it against other writers.
fn open_exclusively(path: &Path, work: &Path) -> Result<File, IndexError> {
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
        // Another writer may have removed the file before it was locked.
        if base::files::is_at(&file, work) {
            return Ok(file);
        }
    }
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

/// The file that a writer of this index works in.
#[must_use]
pub fn work_path(path: &Path) -> PathBuf {
    with_suffix(path, ".work")
}

/// The file that keeps an index that could not be read after it was built again.
#[must_use]
pub fn damaged_path(path: &Path) -> PathBuf {
    with_suffix(path, ".damaged")
}

fn with_suffix(path: &Path, suffix: &str) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(suffix);
    path.with_file_name(name)
}
