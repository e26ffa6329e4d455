//! What can go wrong with an index.

use std::path::PathBuf;

use super::{CodecError, FORMAT_VERSION};

/// Errors of an index file.
#[derive(Debug, thiserror::Error)]
pub enum IndexError {
    /// The operating system refused.
    #[error("cannot {action} {path}: {source}{remedy}", path = path.display(), remedy = remedy(source))]
    Io {
        /// `read`, `write` and the like.
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// What the operating system said.
        source: std::io::Error,
    },
    /// Something else.
    #[error("{path} is not a shape index; make one with `canonform index build`", path = path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Written by a program to come.
    #[error(
        "{path} is an index of format {found}; this program knows formats up to {FORMAT_VERSION}: use a newer one",
        path = path.display()
    )]
    FutureVersion {
        /// The file.
        path: PathBuf,
        /// Its version.
        found: u32,
    },
    /// Not the bytes that were written.
    #[error("{path} is damaged: {what}; restore it, or build it again", path = path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What was found.
        what: String,
    },
    /// Another writer is at work.
    #[error("another program is writing {path}; wait for it to end, or choose another file", path = path.display())]
    Busy {
        /// The index.
        path: PathBuf,
    },
    /// Work of another kind was interrupted.
    #[error(
        "an interrupted `{job}` waits in {work}: run it again to finish it, or delete that file to give it up",
        work = work.display()
    )]
    Unfinished {
        /// What was interrupted.
        job: String,
        /// The file that holds what is done of it.
        work: PathBuf,
    },
    /// Shapes described in different ways cannot be compared.
    #[error(
        "{path} was made with other options ({found}) than these ({asked}); use the same, or another file",
        path = path.display()
    )]
    OtherOptions {
        /// The index.
        path: PathBuf,
        /// What it was made with.
        found: String,
        /// What was asked for.
        asked: String,
    },
    /// Vectors of different length cannot be compared.
    #[error("shape `{id}` has a vector of {found} numbers, the index holds vectors of {expected}")]
    OtherLength {
        /// The shape.
        id: String,
        /// Length of its vector.
        found: usize,
        /// Length of those in the index.
        expected: usize,
    },
    /// A vector that is no place.
    #[error("shape `{id}` has a vector that is empty or not finite; describe it again")]
    BadVector {
        /// The shape.
        id: String,
    },
    /// Two shapes of one name.
    #[error(
        "`{id}` names different shapes in {path} and in what came before it; rename one, or remove it from one",
        path = path.display()
    )]
    Conflict {
        /// The name.
        id: String,
        /// Where its second meaning is.
        path: PathBuf,
    },
    /// A shape that is not there.
    #[error("{path} has no shape `{id}`; `canonform index export` lists all", path = path.display())]
    NoSuchShape {
        /// The index.
        path: PathBuf,
        /// The name.
        id: String,
    },
    /// A value that cannot be stored.
    #[error("shape `{id}` cannot be stored: {source}")]
    Codec {
        /// The shape.
        id: String,
        /// Why.
        source: CodecError,
    },
}

/// What to do about it, where that is clear.
fn remedy(source: &std::io::Error) -> &'static str {
    use std::io::ErrorKind as Kind;
    match source.kind() {
        Kind::StorageFull | Kind::QuotaExceeded | Kind::FileTooLarge => {
            "; make room and run it again, what is done is kept"
        }
        Kind::PermissionDenied | Kind::ReadOnlyFilesystem => "; choose a place that you may write to",
        Kind::NotFound => "; check the path",
        _ => "",
    }
}
