//! The file that a writer works in, and what it records about an interrupted job.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::{Path, PathBuf};

use crate::IndexError;
use crate::format::{CellState, Store};

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

    pub(super) fn write(&self, store: &Store<'_>, cells: CellState) -> Result<(), IndexError> {
        store.write(|transaction| {
            store.make_classes(transaction)?;
            store.set(transaction, "cells", &cells)?;
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
