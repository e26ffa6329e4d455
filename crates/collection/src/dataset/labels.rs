//! Classes of shapes, from names or from a file.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use base::files::FileError;
use mesh::io::{is_mesh_path, without_extension};

use super::shape_file::ShapeFile;
use crate::error::CollectionError;

/// Labels from a file of lines `name,label`.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelFile {
    path: PathBuf,
    labels: HashMap<String, String>,
    in_order: Vec<String>,
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
                    labels.insert(joined(Path::new(name)), label.to_owned());
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
        let key = self.key(name, mesh)?;
        self.labels.get(key).map(String::as_str)
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

    /// Number of lines that name none of these shapes.
    pub fn n_unused(&self, shapes: &[ShapeFile]) -> usize {
        let used: std::collections::HashSet<&str> =
            shapes.iter().filter_map(|shape| self.key(&shape.name, Some(&shape.path))).collect();
        self.labels.len() - used.len()
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
pub(super) fn joined(path: &Path) -> String {
    path.iter().map(|part| part.to_string_lossy()).collect::<Vec<_>>().join("/")
}

/// The class of a shape by its name: its sub-folder, else the leading letters of its file name
/// (`cat0` is a `cat`), else the whole name.
pub fn label_of(name: &str) -> String {
    if let Some((folder, _)) = name.rsplit_once('/') {
        return folder.to_owned();
    }
    let letters = name.trim_start_matches(char::is_alphabetic).len();
    match &name[..name.len() - letters] {
        "" => name.to_owned(),
        leading => leading.to_owned(),
    }
}

/// The class of a shape in a label file, empty if the file does not name it; by its name if there is no file.
pub fn label_in(labels: Option<&LabelFile>, name: &str, mesh: Option<&Path>) -> String {
    labels.map_or_else(|| label_of(name), |file| file.label(name, mesh).unwrap_or_default().to_owned())
}

/// Share of the shapes of a folder without sub-folders that make one label suspicious.
const NEARLY_ALL: f64 = 0.95;

/// Removes labels that come from leading letters, if nearly all shapes would get the same one: names such as `T174` are
/// numbers rather than classes. Returns that label.
///
/// `known` tells labels that are classes already.
pub fn drop_single_class(shapes: &mut [ShapeFile], known: impl Fn(&str) -> bool) -> Option<String> {
    if shapes.len() < 2 || shapes.iter().any(|shape| shape.name.contains('/')) {
        return None;
    }
    let mut counts: HashMap<&str, usize> = HashMap::new();
    shapes.iter().for_each(|shape| *counts.entry(&shape.label).or_default() += 1);
    let (label, count) = counts.iter().max_by_key(|(label, count)| (**count, **label))?;
    let others_are_single = counts.iter().all(|(other, count)| other == label || *count == 1);
    if (*count as f64) < NEARLY_ALL * shapes.len() as f64 || !others_are_single || known(label) {
        return None;
    }
    let label = (*label).to_owned();
    shapes.iter_mut().for_each(|shape| shape.label.clear());
    Some(label)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> LabelFile {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("labels.csv");
        std::fs::write(&path, text).unwrap();
        LabelFile::read(&path).unwrap()
    }

    fn shapes(names: &[&str]) -> Vec<ShapeFile> {
        let shape = |name: &&str| ShapeFile {
            name: (*name).to_owned(),
            label: label_of(name),
            path: format!("{name}.off").into(),
        };
        names.iter().map(shape).collect()
    }

    #[test]
    fn labels_come_from_folders_or_leading_letters() {
        for (name, label) in [("cat0", "cat"), ("cats/sitting1", "cats"), ("0001", "0001"), ("T_rex", "T")] {
            assert_eq!(label_of(name), label);
        }
    }

    #[test]
    fn names_with_dots_are_labelled_and_no_others() {
        let labels = file("name,label\nscan.001,a\nscan.002.off,b\nscan.7,c\nsub/x.off,d\n");
        let of = |name: &str| labels.label(name, Some(Path::new("any.off")));
        assert_eq!(
            [of("scan.001"), of("scan.002"), of("scan"), of("sub/x")],
            [Some("a"), Some("b"), None, Some("d")]
        );
        // Another mesh has another extension.
        assert_eq!(labels.label("scan.002", Some(Path::new("scan.002.ply"))), None);
        // Rows of a matrix are no files.
        assert_eq!([labels.label("scan.002", None), labels.label("scan", None)], [Some("b"), None]);
        assert_eq!(label_in(Some(&labels), "y", None), "");
        assert_eq!(labels.n_unused(&shapes(&["scan.001", "sub/x", "y"])), 2);
    }

    #[test]
    fn one_class_for_nearly_all_shapes_is_none() {
        let names: Vec<String> = (0..40).map(|i| format!("T{i}")).collect();
        let mut numbered = shapes(&names.iter().map(String::as_str).collect::<Vec<_>>());
        assert_eq!(drop_single_class(&mut numbered.clone(), |label| label == "T"), None, "a class by now");
        numbered.extend(shapes(&["query"]));
        assert_eq!(drop_single_class(&mut numbered, |_| false).as_deref(), Some("T"));
        assert!(numbered.iter().all(|shape| shape.label.is_empty()));
        for classes in [&["cat0", "cat1", "dog0", "dog1"][..], &["cat0"], &["cats/0", "cats/1"]] {
            let mut classes = shapes(classes);
            assert_eq!(drop_single_class(&mut classes, |_| false), None);
            assert!(classes.iter().all(|shape| !shape.label.is_empty()));
        }
        // A few of one class beside many of another are two classes.
        let mut skewed = shapes(&[&vec!["cat0"; 98][..], &["dog0", "dog1"]].concat());
        assert_eq!(drop_single_class(&mut skewed, |_| false), None);
    }
}
