//! Kinds of files that hold meshes.

use std::path::Path;

use mesh::{Fault, MeshError, Place};
use mesh_io::{extension, is_gzip};

/// What holds several meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Container {
    Folder,
    Zip,
    Tar,
    Parquet,
    List,
}

impl Container {
    /// Judges by the extension.
    pub(super) fn by_name(path: &Path) -> Option<Self> {
        Some(match (extension(path).as_str(), is_gzip(path)) {
            ("zip", false) => Self::Zip,
            ("tar", _) | ("tgz", false) => Self::Tar,
            ("parquet", false) => Self::Parquet,
            ("txt" | "list", false) => Self::List,
            _ => return None,
        })
    }

    /// What a path leads to; `None` if that is no container.
    pub(crate) fn of(path: &Path) -> Option<Self> {
        match Self::by_name(path) {
            _ if path.is_dir() => Some(Self::Folder),
            Some(container) if path.is_file() => Some(container),
            _ => None,
        }
    }

    pub(super) fn is_archive(self) -> bool {
        matches!(self, Self::Zip | Self::Tar | Self::Parquet)
    }
}

/// Whether the members of an archive in a folder are found: its list of members is read without decompressing all of it.
pub(crate) fn has_members(path: &Path) -> bool {
    match Container::by_name(path) {
        Some(Container::Zip) => true,
        Some(Container::Tar) => extension(path) == "tar" && !is_gzip(path),
        _ => false,
    }
}

/// Whether a name is that of an archive or of a file that is compressed in a way that is not read.
pub(crate) fn is_archive_like(path: &Path) -> bool {
    matches!(Container::by_name(path), Some(Container::Zip | Container::Tar)) || is_unread_archive(path)
}

/// Whether a name is that of a file that is compressed in a way that is not read.
pub(crate) fn is_unread_archive(path: &Path) -> bool {
    let known = ["7z", "bz2", "lz", "lz4", "lzma", "rar", "tbz", "tbz2", "txz", "tzst", "xz", "z", "zst"];
    known.contains(&extension(path).as_str())
}

/// The error that a file cannot be read faithfully.
pub(super) fn fault(path: &Path, fault: Fault) -> MeshError {
    MeshError::File { path: path.to_owned(), place: Place::File, fault }
}
