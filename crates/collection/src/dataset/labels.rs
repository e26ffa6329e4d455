//! Classes of shapes from a file.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use base::files::FileError;
use mesh::io::{is_mesh_path, without_extension};
use serde::Serialize;

use super::shape_file::ShapeFile;
use crate::error::CollectionError;

/// Labels from a file of lines `name,label`.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelFile {
    path: PathBuf,
    /// The number of the line and the label, by the name of the shape.
    labels: HashMap<String, (usize, String)>,
    in_order: Vec<String>,
}

/// A line of a label file that names no shape.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct UnusedLabel {
    /// Its number, from 1.
    pub line: usize,
    /// The name in it.
    pub name: String,
}

impl LabelFile {
    /// Reads a label file. Names are those of [`ShapeFile`], with or without the extension of the mesh; empty lines, lines
    /// that begin with `#` and a header `name,label` are skipped. A file of labels without names labels the rows of a
    /// matrix in their order. The file need not name all shapes.
    ///
    /// # Errors
    /// [`CollectionError::File`] and [`CollectionError::BadLine`].
    pub fn read(path: &Path) -> Result<Self, CollectionError> {
        let text = std::fs::read_to_string(path).map_err(|source| FileError::read(path, source))?;
        let (mut labels, mut in_order) = (HashMap::new(), Vec::new());
        let has_names = text.contains(',');
        for (number, line) in text.lines().enumerate() {
            let line = line.trim();
            if line.is_empty() || line.starts_with('#') || (number == 0 && line == "name,label") {
                continue;
            }
            match line.split(',').map(str::trim).collect::<Vec<_>>()[..] {
                [name, label] if !name.is_empty() && !label.is_empty() => {
                    labels.insert(joined(Path::new(name)), (number + 1, label.to_owned()));
                    in_order.push(label.to_owned());
                }
                [label] if !has_names => in_order.push(label.to_owned()),
                _ => {
                    let what = format!("expected `name,label`, found `{line}`");
                    return Err(CollectionError::BadLine { path: path.to_owned(), line: number + 1, what });
                }
            }
        }
        Ok(Self { path: path.to_owned(), labels, in_order })
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The labels in the order of the lines.
    pub fn in_order(&self) -> &[String] {
        &self.in_order
    }

    /// The label of a shape, if the file names it: as `scan.001`, or with the extension of its mesh as `scan.001.off`.
    pub fn label(&self, name: &str, mesh: Option<&Path>) -> Option<&str> {
        let (_, label) = self.labels.get(self.key(name, mesh)?)?;
        Some(label)
    }

    /// How the file names a shape.
    fn key(&self, name: &str, mesh: Option<&Path>) -> Option<&str> {
        let found = self.labels.get_key_value(name);
        let found = found.or_else(|| match mesh.and_then(Path::extension) {
            Some(_) => extensions_of(mesh)
                .find_map(|extension| self.labels.get_key_value(&format!("{name}.{extension}"))),
            // The mesh is unknown: any mesh of this name.
            None => self.labels.iter().find(|(key, _)| is_mesh_named(key, name)),
        });
        found.map(|(key, _)| key.as_str())
    }

    /// The lines that name none of these shapes, in their order.
    pub fn unused(&self, shapes: &[ShapeFile]) -> Vec<UnusedLabel> {
        let used: HashSet<&str> =
            shapes.iter().filter_map(|shape| self.key(&shape.name, Some(&shape.path))).collect();
        let unused = self.labels.iter().filter(|(name, _)| !used.contains(name.as_str()));
        let mut lines: Vec<UnusedLabel> =
            unused.map(|(name, (line, _))| UnusedLabel { line: *line, name: name.clone() }).collect();
        lines.sort_by_key(|unused| unused.line);
        lines
    }
}

/// The extension of a mesh: `off`, or for a compressed file both `off.gz` and `off`.
fn extensions_of(mesh: Option<&Path>) -> impl Iterator<Item = String> {
    let name = mesh.and_then(Path::file_name).unwrap_or_default().to_string_lossy().into_owned();
    let stem = mesh.map(without_extension).unwrap_or_default();
    let stem = stem.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let full = name.strip_prefix(&stem).unwrap_or_default().trim_start_matches('.').to_owned();
    let short = full.split_once('.').map(|(short, _)| short.to_owned());
    std::iter::once(full).chain(short)
}

/// Whether a key is this name with the extension of a mesh.
fn is_mesh_named(key: &str, name: &str) -> bool {
    let rest = key.strip_prefix(name).and_then(|rest| rest.strip_prefix('.'));
    rest.is_some_and(|extension| !extension.contains('.')) && is_mesh_path(Path::new(key))
}

/// A path separated by `/`.
pub(crate) fn joined(path: &Path) -> String {
    path.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_with_dots_are_labelled_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.csv");
        std::fs::write(&path, "name,label\nscan.001,a\nscan.002.off,b\nscan.7,c\nsub/x.off,d\n").unwrap();
        let labels = LabelFile::read(&path).unwrap();
        let of = |name: &str| labels.label(name, Some(Path::new("any.off")));
        assert_eq!(
            [of("scan.001"), of("scan.002"), of("scan"), of("sub/x")],
            [Some("a"), Some("b"), None, Some("d")]
        );
        // Another mesh has another extension.
        assert_eq!(labels.label("scan.002", Some(Path::new("scan.002.ply"))), None);
        // Rows of a matrix are no files.
        assert_eq!([labels.label("scan.002", None), labels.label("scan", None)], [Some("b"), None]);
        let shape = |name: &str| ShapeFile {
            name: name.to_owned(),
            label: String::new(),
            path: format!("{name}.off").into(),
        };
        let unused = labels.unused(&["scan.001", "sub/x", "y"].map(shape));
        let unused: Vec<_> = unused.iter().map(|unused| (unused.line, unused.name.as_str())).collect();
        assert_eq!(unused, [(3, "scan.002.off"), (4, "scan.7")]);
    }
}
