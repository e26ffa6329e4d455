//! Errors of the file system.

use std::io;
use std::path::{Path, PathBuf};

/// A file that could not be read or written.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {path}: {source}{}", remedy(source))]
pub struct FileError {
    /// What failed, `read` or `write`.
    pub action: &'static str,
    /// The file.
    pub path: PathBuf,
    /// The error of the operating system.
    pub source: io::Error,
}

/// What to do about an error of the operating system, after `; `; empty if nobody can say.
pub fn remedy(source: &io::Error) -> &'static str {
    use io::ErrorKind as Kind;
    match source.kind() {
        Kind::StorageFull | Kind::QuotaExceeded => "; free some space",
        Kind::FileTooLarge => "; the disk takes no file of this size: choose another one",
        Kind::ReadOnlyFilesystem => "; choose a folder that can be written to",
        Kind::PermissionDenied => "; check its permissions",
        Kind::NotFound => "; check that the path exists",
        Kind::InvalidFilename => "; the name is too long or not allowed: choose another one",
        Kind::IsADirectory => "; this is a folder: give a file",
        Kind::NotADirectory => "; check the path: a part of it is a file, not a folder",
        Kind::ResourceBusy => "; choose another name for the result, or close the program that uses it",
        Kind::OutOfMemory => "; close other programs, or use a smaller file",
        _ => "",
    }
}

impl FileError {
    /// The error that a file could not be read.
    pub fn read(path: &Path, source: io::Error) -> Self {
        Self { action: "read", path: path.to_path_buf(), source }
    }

    /// The error that a file could not be written.
    pub fn write(path: &Path, source: io::Error) -> Self {
        Self { action: "write", path: path.to_path_buf(), source }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_remedy_depends_on_the_fault() {
        use io::ErrorKind as Kind;
        for (kind, words) in [
            (Kind::StorageFull, "free some space"),
            (Kind::PermissionDenied, "permissions"),
            (Kind::NotFound, "path exists"),
            (Kind::ReadOnlyFilesystem, "a folder that can be written to"),
            (Kind::InvalidFilename, "too long"),
            (Kind::IsADirectory, "give a file"),
        ] {
            let fault = FileError::write(Path::new("a.off"), kind.into()).to_string();
            assert!(fault.starts_with("cannot write a.off: ") && fault.contains(words), "{fault}");
        }
        let other = FileError::read(Path::new("a.off"), io::Error::other("damaged")).to_string();
        assert_eq!(other, "cannot read a.off: damaged");
    }
}
