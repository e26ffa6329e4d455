//! Which file a name stands for.

use std::fs::{self, File};
use std::io;
use std::path::Path;

/// What tells files and folders apart, whatever their names: device and inode; elsewhere than on Unix the path without links.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub struct FileId(#[cfg(unix)] [u64; 2], #[cfg(not(unix))] std::path::PathBuf);

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
    fn of_metadata(metadata: &fs::Metadata) -> Self {
        use std::os::unix::fs::MetadataExt;
        Self([metadata.dev(), metadata.ino()])
    }
}

/// Whether two paths lead to one file. False if one of them leads nowhere.
pub fn is_same_file(a: &Path, b: &Path) -> bool {
    matches!((FileId::of(a), FileId::of(b)), (Ok(a), Ok(b)) if a == b)
}

/// Whether an open file still has this name. Elsewhere than on Unix open files cannot be renamed.
#[cfg_attr(not(unix), expect(unused_variables))]
pub fn is_at(file: &File, path: &Path) -> bool {
    #[cfg(unix)]
    return file
        .metadata()
        .is_ok_and(|open| FileId::of(path).is_ok_and(|named| named == FileId::of_metadata(&open)));
    #[cfg(not(unix))]
    return path.exists();
}

/// Whether an open file has several names (hard links), as far as is known.
#[cfg_attr(not(unix), expect(unused_variables))]
pub fn has_other_names(file: &File) -> bool {
    #[cfg(unix)]
    return file.metadata().is_ok_and(|about| std::os::unix::fs::MetadataExt::nlink(&about) > 1);
    #[cfg(not(unix))]
    return false;
}
