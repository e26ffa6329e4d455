//! Errors of exports.

use std::io;

use crate::IndexError;

/// Errors of an export.
#[derive(Debug, thiserror::Error)]
pub enum ExportError {
    /// The index cannot be read.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The text cannot be written.
    #[error("cannot write the export: {0}")]
    Write(#[from] io::Error),
}
