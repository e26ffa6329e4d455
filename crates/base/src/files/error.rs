//! Errors of the file system.

use std::fmt;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// A file that could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {path}: {source}; {}", advice(source))]
pub struct FileError {
    /// The failed action.
    pub action: Action,
    /// The file.
    pub path: PathBuf,
    /// The error of the operating system.
    pub source: io::Error,
}

/// An action on a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Action {
    /// Reading.
    Read,
    /// Writing.
    Write,
}

impl fmt::Display for Action {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Read => "read",
            Self::Write => "write",
        })
    }
}

/// What to do about an error of the system.
fn advice(source: &io::Error) -> &'static str {
    match source.kind() {
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => "free some space",
        ErrorKind::ResourceBusy => "choose another name for the result",
        _ => "check that the path exists and its permissions allow it",
    }
}

impl FileError {
    /// The error that a file could not be read.
    pub fn read(path: &Path, source: io::Error) -> Self {
        Self { action: Action::Read, path: path.to_path_buf(), source }
    }

    /// The error that a file could not be written.
    pub fn write(path: &Path, source: io::Error) -> Self {
        Self { action: Action::Write, path: path.to_path_buf(), source }
    }
}
