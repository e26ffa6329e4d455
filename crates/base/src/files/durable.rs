//! Names that survive a power failure.

use std::fs::File;
use std::io;
use std::path::Path;

use super::error::FileError;

/// The folder that holds a file.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Flushes the folder of a file, and with it the name of the file, to disk.
pub(crate) fn sync_folder(path: &Path) -> io::Result<()> {
    match cfg!(unix) {
        true => File::open(folder_of(path))?.sync_all(),
        false => Ok(()),
    }
}

/// Renames a file whose content is on disk; the new name is on disk when it returns.
///
/// # Errors
/// [`FileError`] with the new path.
pub fn rename_durably(from: &Path, to: &Path) -> Result<(), FileError> {
    std::fs::rename(from, to).and_then(|()| sync_folder(to)).map_err(|source| FileError::write(to, source))
}
