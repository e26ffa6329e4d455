//! Errors of this crate.

use std::collections::BTreeMap;
use std::path::PathBuf;

use base::files::FileError;
use mesh::MeshError;

/// A collection that cannot be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum CollectionError {
    /// A folder or a text file that cannot be read.
    #[error(transparent)]
    File(#[from] FileError),
    /// An archive or a mesh that cannot be read.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A line of a list of paths or of a file of labels.
    #[error("{path}, line {line}: {what}", path = path.display())]
    BadLine {
        /// The file.
        path: PathBuf,
        /// The line, counted from one.
        line: usize,
        /// What is wrong and what is expected.
        what: String,
    },
    /// A file of labels that names none of the shapes.
    #[error(
        "{path}: none of its lines names a shape: line {line} has `{name}`, and the first shape is `{shape}`; write a name \
         and a label in every line",
        path = path.display()
    )]
    NoLabelFits {
        /// The file.
        path: PathBuf,
        /// Its first line with a label.
        line: usize,
        /// How that line begins.
        name: String,
        /// The name of the first shape.
        shape: String,
    },
    /// An archive of another number of meshes where one is wanted.
    #[error("{path}: the archive holds {n_meshes} meshes{}, not one", such_as(first), path = path.display())]
    NotOneMesh {
        /// The archive.
        path: PathBuf,
        /// Its meshes.
        n_meshes: usize,
        /// The names of the first few of them.
        first: Vec<String>,
    },
    /// An archive or a compressed file of a kind that is not read.
    #[error(
        "{path}: this kind of archive is not read; unpack it, or pack its files as .zip, .tar or .tar.gz",
        path = path.display()
    )]
    UnreadArchive {
        /// The archive.
        path: PathBuf,
    },
    /// A file that is no dataset.
    #[error(
        "{path}: this file is not a dataset; a dataset is a folder, a .zip, .tar or .tar.gz archive, a .parquet file, or a \
         .txt or .list file with a path in every line",
        path = path.display()
    )]
    NotADataset {
        /// The file.
        path: PathBuf,
    },
    /// A folder, an archive or a list without meshes.
    #[error(
        "{path}: no mesh found in it or its sub-folders{}; \
         a mesh is {meshes}",
        skipping(skipped),
        path = path.display(),
        meshes = mesh_io::mesh_files()
    )]
    NoShapes {
        /// The folder.
        path: PathBuf,
        /// How much was skipped although it may hold meshes, by the reason.
        skipped: BTreeMap<String, usize>,
    },
}

fn skipping(counts: &BTreeMap<String, usize>) -> String {
    let counts: Vec<String> = counts.iter().map(|(kind, n)| format!("{kind} ({n})")).collect();
    if counts.is_empty() { String::new() } else { format!(", skipping {}", counts.join(", ")) }
}

fn such_as(names: &[String]) -> String {
    match names {
        [] => String::new(),
        _ => format!(", such as {}", names.join(", ")),
    }
}
