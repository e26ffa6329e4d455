//! Files that are there whole or not at all.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::NamedTempFile;

use crate::MeshError;

/// The temporary files of this process. Whoever makes one, puts it into its place or removes it holds
/// the lock meanwhile, so that the list is always true.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes the temporary files of all that is being written: the last thing a program does that was
/// told to stop.
///
/// From now on whoever begins or ends to write a file in this process waits for ever, so that nothing
/// is left behind until it exits.
pub fn abandon_unfinished() {
    let paths = unfinished();
    for path in paths.iter() {
        // What cannot be removed can only be left.
        let _ = std::fs::remove_file(path);
    }
    std::mem::forget(paths);
}

/// A file written next to its destination but not yet in its place.
pub(super) struct Pending<'a> {
    /// Taken when it is published or dropped.
    file: Option<NamedTempFile>,
    path: &'a Path,
}

impl<'a> Pending<'a> {
    /// Writes all of a file from front to back; on any error nothing remains.
    pub(super) fn write(
        path: &'a Path,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, MeshError> {
        Self::fill(path, |file| {
            let mut out = BufWriter::with_capacity(1 << 16, file);
            content(&mut out)?;
            out.flush()
        })
    }

    /// Writes all of a file in any order; on any error nothing remains.
    pub(super) fn fill(
        path: &'a Path,
        content: impl FnOnce(&mut File) -> io::Result<()>,
    ) -> Result<Self, MeshError> {
        let written = || {
            let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let mut pending = Self { file: Some(new_file_in(folder)?), path };
            if let Some(file) = &mut pending.file {
                content(file.as_file_mut())?;
            }
            Ok(pending)
        };
        written().map_err(|source| cannot_write(path, source))
    }

    /// Puts the file into its place, over what was there.
    pub(super) fn publish(mut self) -> Result<(), MeshError> {
        let Some(file) = self.file.take() else { return Ok(()) };
        let mut paths = unfinished();
        forget(&mut paths, file.path());
        file.persist(self.path).map(drop).map_err(|e| cannot_write(self.path, e.error))
    }
}

impl Drop for Pending<'_> {
    fn drop(&mut self) {
        if let Some(file) = self.file.take() {
            let mut paths = unfinished();
            forget(&mut paths, file.path());
            drop(file);
        }
    }
}

fn forget(paths: &mut Vec<PathBuf>, path: &Path) {
    paths.retain(|unfinished| unfinished != path);
}

/// A temporary file with the permissions of an ordinary new one, not only for its owner.
fn new_file_in(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(".unfinished-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    let mut paths = unfinished();
    let file = builder.tempfile_in(folder)?;
    paths.push(file.path().to_owned());
    Ok(file)
}

fn cannot_write(path: &Path, source: io::Error) -> MeshError {
    MeshError::Io { action: "write", path: path.to_path_buf(), source }
}
