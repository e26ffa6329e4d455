//! Which file a name stands for.

#[cfg(unix)]
use std::fs::Metadata;
use std::fs::{self, File};
use std::io;
use std::path::Path;
#[cfg(not(unix))]
use std::path::PathBuf;

/// What tells files and folders apart, whatever their names: device and inode.
#[cfg(unix)]
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FileId {
    device: u64,
    inode: u64,
}

/// What tells files and folders apart, whatever their names: the path without links.
#[cfg(not(unix))]
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FileId(PathBuf);

impl FileId {
    /// Follows links.
    ///
    /// # Errors
    /// If there is no such file, or links end nowhere.
    pub fn of(path: &Path) -> io::Result<Self> {
        #[cfg(unix)]
        return Ok(Self::of_metadata(&fs::metadata(path)?));
        #[cfg(not(unix))]
        return Ok(Self(fs::canonicalize(path)?));
    }

    #[cfg(unix)]
    fn of_metadata(metadata: &Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self { device: metadata.dev(), inode: metadata.ino() }
    }
}

/// Whether two paths lead to one file. False if one of them leads nowhere.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((FileId::of(a), FileId::of(b)), (Ok(a), Ok(b)) if a == b)
}

/// Whether an open file still has this name.
#[cfg(unix)]
pub fn is_at(file: &File, path: &Path) -> bool {
    file.metadata().is_ok_and(|open| FileId::of(path).is_ok_and(|named| named == FileId::of_metadata(&open)))
}

/// Whether an open file still has this name: here open files cannot be renamed.
#[cfg(not(unix))]
pub fn is_at(_: &File, path: &Path) -> bool {
    path.exists()
}

/// Whether an open file has several names (hard links).
#[cfg(unix)]
pub fn has_other_names(file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    file.metadata().is_ok_and(|about| about.nlink() > 1)
}

/// Whether an open file has several names (hard links): unknown here.
#[cfg(not(unix))]
pub fn has_other_names(_: &File) -> bool {
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_one_file_are_the_same() {
        let folder = tempfile::tempdir().unwrap();
        let [a, b] = ["a", "b"].map(|name| folder.path().join(name));
        fs::write(&a, "x").unwrap();
        assert!(!is_same_file(&a, &b));
        fs::write(&b, "x").unwrap();
        assert!(!is_same_file(&a, &b));
        assert!(is_same_file(&a, &folder.path().join(".").join("a")));
        let open = File::open(&a).unwrap();
        assert!(is_at(&open, &a) && !is_at(&open, &b));
    }
}
