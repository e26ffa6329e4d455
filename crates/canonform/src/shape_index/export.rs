//! Writing an index as text or arrays.

use std::path::Path;

use base::files::{FileError, fill_atomically};
use index::{ExportFormat, Index, IndexError};

use crate::error::Error;

/// Writes an index to a file in some format, completely or not at all.
///
/// # Errors
/// [`Error::Index`] if the index cannot be read, [`Error::File`].
pub fn export_index(index: &Index, format: ExportFormat, path: &Path) -> Result<(), Error> {
    let written = fill_atomically(path, |file| index.export_as(format, file));
    written.map_err(|FileError { source, action, path }| match source.downcast::<IndexError>() {
        Ok(unreadable) => unreadable.into(),
        Err(source) => FileError { source, action, path }.into(),
    })
}
