//! A mesh file with a name and a class.

use std::path::PathBuf;

/// A mesh file of a dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShapeFile {
    /// Its path below the folder, archive or list, without extension: `cats/sitting`.
    pub name: String,
    /// Its class; empty if it has none.
    pub label: String,
    /// Path of the file; of a member of an archive, `cats.zip/sitting.off`.
    pub path: PathBuf,
}
