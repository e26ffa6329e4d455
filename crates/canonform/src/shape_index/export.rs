//! Writing an index as text or arrays.

use std::path::Path;

use base::files::fill_atomically;
use index::{ExportError, ExportFormat, Index};

use crate::error::Error;

/// Writes an index to a file in some format, completely or not at all.
///
/// # Errors
/// [`Error::Index`] if the index cannot be read, [`Error::File`].
pub fn export_index(index: &Index, format: ExportFormat, path: &Path) -> Result<(), Error> {
    let mut unreadable = None;
    let written = fill_atomically(path, |file| match index.export_as(format, file) {
        Ok(()) => Ok(()),
        Err(ExportError::Write(fault)) => Err(fault),
        Err(ExportError::Index(fault)) => {
            unreadable = Some(fault);
            Err(std::io::Error::other("the index cannot be read"))
        }
    });
    unreadable.map_or(Ok(()), Err)?;
    Ok(written?)
}
