//! Errors of an index.

use std::io;
use std::path::{Path, PathBuf};

/// Version of the file format, which an error about another one states.
pub const FORMAT_VERSION: u32 = 6;

/// Errors of an index.
#[derive(Debug, thiserror::Error)]
pub enum IndexError {
    /// The operating system refused an operation.
    #[error("cannot {action} {path}: {source}{remedy}", path = path.display(), remedy = remedy(source))]
    Io {
        /// The operation: `read`, `write` or `remove`.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The error of the operating system.
        source: io::Error,
    },
    /// The file is not an index.
    #[error("{path} is not a shape index", path = .0.display())]
    Foreign(PathBuf),
    /// A newer version of the program wrote the file.
    #[error(
        "{path} is an index of format {found}; this program reads format {FORMAT_VERSION}: use a newer version",
        path = path.display()
    )]
    FutureVersion {
        /// The file.
        path: PathBuf,
        /// Its format version.
        found: u32,
    },
    /// An older version of the program wrote the file.
    #[error(
        "{path} is an index of format {found}; this program reads format {FORMAT_VERSION}",
        path = path.display()
    )]
    PastVersion {
        /// The file.
        path: PathBuf,
        /// Its format version.
        found: u32,
    },
    /// The content differs from what was written.
    #[error("{path} is damaged: {what}", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        what: String,
    },
    /// The file took the place of another one, whose changes are in the log beside it.
    #[error(
        "the changes in {path}-wal belong to another file than {path}; if they are not needed, end the programs that use it \
         and delete {path}-wal",
        path = .0.display()
    )]
    OtherLog(PathBuf),
    /// Another program is writing the index.
    #[error("another program is writing {path}; wait until it ends, or choose another file", path = .0.display())]
    Busy(PathBuf),
    /// The index was made with other options, so its shapes cannot be compared with others.
    #[error(
        "{path} was made with other options ({found}) than these ({requested}); use the same, or another file",
        path = path.display()
    )]
    OtherOptions {
        /// The index.
        path: PathBuf,
        /// The options it was made with.
        found: String,
        /// The requested options.
        requested: String,
    },
    /// A vector has another length than those in the index.
    #[error("shape `{id}` has a vector of {found} numbers, the index holds vectors of {expected}")]
    OtherLength {
        /// The shape.
        id: String,
        /// Length of its vector.
        found: usize,
        /// Length of the vectors in the index.
        expected: usize,
    },
    /// The vector of this shape is empty or has a component that is NaN or infinite.
    #[error("shape `{0}` has a vector that is empty or not finite; describe it again")]
    BadVector(String),
    /// Two different shapes have the same name.
    #[error(
        "`{id}` names different shapes in {path} and in an index before it; rename one, or remove it from one of them",
        path = path.display()
    )]
    Conflict {
        /// The name.
        id: String,
        /// The index that holds the second shape.
        path: PathBuf,
    },
    /// The index has no shape of this name.
    #[error("{path} has no shape `{id}`", path = path.display())]
    NoSuchShape {
        /// The index.
        path: PathBuf,
        /// The name.
        id: String,
    },
}

/// Of an index that cannot be read while it is written elsewhere.
impl From<IndexError> for io::Error {
    fn from(fault: IndexError) -> Self {
        Self::other(fault)
    }
}

impl IndexError {
    /// Turns an error of the operating system into one that names the file.
    pub(crate) fn io(action: &'static str, path: &Path) -> impl Fn(io::Error) -> Self + Copy {
        move |source| Self::Io { action, path: path.to_owned(), source }
    }

    /// A file of another format version.
    pub(crate) fn other_version(path: &Path, found: u32) -> Self {
        let path = path.to_owned();
        match found < FORMAT_VERSION {
            true => Self::PastVersion { path, found },
            false => Self::FutureVersion { path, found },
        }
    }

    pub(crate) fn damaged(path: &Path, what: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_owned(), what: what.into() }
    }
}

/// The remedy for an error of the operating system, where there is an obvious one.
fn remedy(source: &io::Error) -> &'static str {
    use io::ErrorKind as Kind;
    match source.kind() {
        Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge => {
            "; free some space and run it again, finished work is kept"
        }
        _ => base::files::remedy(source),
    }
}
