//! Lists of paths.

use std::path::{Component, Path, PathBuf};

use base::files::FileError;

use crate::error::CollectionError;
use crate::table::{decode, lines};

/// Reads a list: one path a line, relative to the folder of the list. Empty lines and lines that begin with `#` are skipped.
/// Returns the paths, relative to the current folder, and their lines, counted from one.
pub(crate) fn read(list: &Path) -> Result<Vec<(PathBuf, usize)>, CollectionError> {
    let text = decode(std::fs::read(list).map_err(|source| FileError::read(list, source))?, list)?;
    let folder = list.parent().unwrap_or(Path::new(""));
    lines(&text)
        .map(|(line, text)| {
            let path = tidy(&folder.join(text));
            match path.is_dir() {
                false => Ok((path, line)),
                true => {
                    let what = format!("{text} is a folder; a list names meshes, one a line");
                    Err(CollectionError::BadLine { path: list.to_owned(), line, what })
                }
            }
        })
        .collect()
}

/// A path without `.`.
fn tidy(path: &Path) -> PathBuf {
    path.components().filter(|part| *part != Component::CurDir).collect()
}
