//! Classes of shapes from a file.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use mesh_io::{is_mesh_path, without_extension};
use serde::Serialize;

use super::shape_file::ShapeFile;
use crate::error::CollectionError;
use crate::table::TextTable;

/// Labels from a file of lines `name,label`.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelFile {
    /// The file.
    pub path: PathBuf,
    /// The number of the line and the label, by the name of the shape.
    labels: HashMap<String, (usize, String)>,
    /// The labels in the order of the lines.
    pub in_order: Vec<String>,
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
    /// Reads a label file, a [`TextTable`]. Names are those of [`ShapeFile`], with or without the extension of the mesh; a header
    /// such as `name,label` is skipped. Where a line has more cells, the last one is the label. A file of labels without names labels the rows of a matrix in their order. The file
    /// need not name all shapes.
    ///
    /// # Errors
    /// [`CollectionError::File`] and [`CollectionError::BadLine`].
    pub fn read(path: &Path) -> Result<Self, CollectionError> {
        let table = TextTable::read(path)?;
        let (mut labels, mut in_order) = (HashMap::new(), Vec::new());
        let has_names = table.rows().any(|row| row.n_cells() > 1);
        for (number, row) in table.rows().enumerate() {
            let mut cells: Vec<&str> = row.cells().collect();
            // Spreadsheets fill short rows up.
            while cells.len() > 2 && cells.last() == Some(&"") {
                cells.pop();
            }
            // A name may hold separators: the label is the last cell.
            let name = row.before(cells.len() - 1).filter(|_| cells.len() > 2);
            if let (Some(name), Some(&label)) = (&name, cells.last()) {
                cells = vec![name, label];
            }
            match cells[..] {
                [name, label] if number == 0 && is_header(name, label) => {}
                [name, label] if !name.is_empty() && !label.is_empty() => {
                    let known = labels.insert(joined(Path::new(name)), (row.line, label.to_owned()));
                    if let Some((line, other)) = known.filter(|(_, other)| other != label) {
                        let what = format!("`{name}` has the label `{other}` in line {line}; give it one");
                        return Err(row.fault(what));
                    }
                    in_order.push(label.to_owned());
                }
                [label] if !has_names => in_order.push(label.to_owned()),
                _ => {
                    let found = cells.join(",");
                    return Err(row.fault(format!("expected `name,label`, found `{found}`")));
                }
            }
        }
        Ok(Self { path: path.to_owned(), labels, in_order })
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
    ///
    /// # Errors
    /// [`CollectionError::NoLabelFits`] if the lines have labels only.
    pub fn unused(&self, shapes: &[ShapeFile]) -> Result<Vec<UnusedLabel>, CollectionError> {
        let used: HashSet<&str> =
            shapes.iter().filter_map(|shape| self.key(&shape.name, Some(&shape.path))).collect();
        let unused = self.labels.iter().filter(|(name, _)| !used.contains(name.as_str()));
        let mut lines: Vec<UnusedLabel> =
            unused.map(|(name, (line, _))| UnusedLabel { line: *line, name: name.clone() }).collect();
        lines.sort_by_key(|unused| unused.line);
        match shapes {
            [shape, ..] if self.labels.is_empty() => Err(self.fits_none(&shape.name)),
            _ => Ok(lines),
        }
    }

    /// The error that no line names a shape, such as this one.
    pub fn fits_none(&self, shape: &str) -> CollectionError {
        let first = self.labels.iter().map(|(name, (line, _))| (*line, name)).min();
        let (line, name) = first.or(self.in_order.first().map(|label| (1, label))).unzip();
        let (line, name) = (line.unwrap_or(1), name.cloned().unwrap_or_default());
        CollectionError::NoLabelFits { path: self.path.clone(), line, name, shape: shape.to_owned() }
    }
}

/// Whether the first line of a file names its columns.
fn is_header(name: &str, label: &str) -> bool {
    let is = |word: &str, known: &[&str]| known.iter().any(|known| word.eq_ignore_ascii_case(known));
    is(name, &["name", "id", "file", "shape"]) && is(label, &["label", "class"])
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
        // Another mesh has another extension, and a compressed one two.
        assert_eq!(labels.label("scan.002", Some(Path::new("scan.002.ply"))), None);
        assert_eq!(labels.label("scan.002", Some(Path::new("scan.002.off.gz"))), Some("b"));
        // Rows of a matrix are no files.
        assert_eq!([labels.label("scan.002", None), labels.label("scan", None)], [Some("b"), None]);
        let shape = |name: &str| ShapeFile {
            name: name.to_owned(),
            label: String::new(),
            path: format!("{name}.off").into(),
        };
        let unused = labels.unused(&["scan.001", "sub/x", "y"].map(shape)).unwrap();
        let unused: Vec<_> = unused.iter().map(|unused| (unused.line, unused.name.as_str())).collect();
        assert_eq!(unused, [(3, "scan.002.off"), (4, "scan.7")]);
        let fault = labels.fits_none("cat1").to_string();
        assert!(
            fault.contains("labels.csv: none of its lines names a shape: line 2 has `scan.001`"),
            "{fault}"
        );
        assert!(fault.contains("the first shape is `cat1`"), "{fault}");
    }

    #[test]
    fn label_files_of_spreadsheets_are_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.csv");
        let read = |text: &str| {
            std::fs::write(&path, text).unwrap();
            LabelFile::read(&path).map_err(|fault| fault.to_string())
        };
        for text in [
            "\u{feff}id\tClass\ncat0\tcat\ncats, old\tpet\n",
            "name,label,\ncat0,cat,\n\"cats, old\",pet,,\n",
        ] {
            let labels = read(text).unwrap();
            let found = ["cat0", "cats, old"].map(|name| labels.label(name, None));
            assert_eq!((found, labels.in_order.len()), ([Some("cat"), Some("pet")], 2), "{text:?}");
        }
        for (text, what) in [
            ("cat0;cat\ncat1\n", "line 2: expected `name,label`, found `cat1`"),
            ("cat0,\n", "line 1: expected `name,label`"),
            ("cat0,cat\ncat0,dog\n", "line 2: `cat0` has the label `cat` in line 1"),
        ] {
            let fault = read(text).unwrap_err();
            assert!(fault.contains(what), "{text:?}: {fault}");
        }
        let labels = read("cat0,cat\ncats, old, large.off,pet\n").unwrap();
        assert_eq!(labels.label("cats, old, large", None), Some("pet"));
        // Labels without names are those of the rows of a matrix, not of shapes.
        let labels = read("cat\ndog\n").unwrap();
        assert!(labels.fits_none("cat0").to_string().contains("line 1 has `cat`"));
    }
}
