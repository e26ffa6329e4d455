//! A folder of meshes as a labelled dataset.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use files::FileError;
use mesh::io::is_mesh_path;

use crate::error::Error;

/// A mesh file of a dataset.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ShapeFile {
    /// Its path below the folder, without extension: `cats/sitting`.
    pub name: String,
    /// Its class.
    pub label: String,
    /// Path of the file.
    pub path: PathBuf,
}

/// Labels from a file of lines `name,label`.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelFile {
    path: PathBuf,
    labels: HashMap<String, String>,
    in_order: Vec<String>,
}

impl LabelFile {
    /// Reads a label file. Names are those of [`ShapeFile`], with or without extension; empty lines, lines that
    /// begin with `#` and a header `name,label` are skipped. A file of labels without names labels the rows of a
    /// matrix in their order.
    ///
    /// # Errors
    /// [`Error::File`] and [`Error::BadLine`].
    pub fn read(path: &Path) -> Result<Self, Error> {
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
                    labels.insert(stem(Path::new(name)), label.to_owned());
                    in_order.push(label.to_owned());
                }
                [label] if !has_names => in_order.push(label.to_owned()),
                _ => {
                    let what = format!("expected `name,label`, found `{line}`");
                    return Err(Error::BadLine { path: path.to_owned(), line: number + 1, what });
                }
            }
        }
        Ok(Self { path: path.to_owned(), labels, in_order })
    }

    /// The labels in the order of the lines.
    pub(crate) fn in_order(&self) -> &[String] {
        &self.in_order
    }

    pub(crate) fn label(&self, name: &str) -> Result<String, Error> {
        self.labels
            .get(name)
            .cloned()
            .ok_or_else(|| Error::NoLabel { path: self.path.clone(), name: name.to_owned() })
    }
}

/// The path without extension, separated by `/`.
fn stem(path: &Path) -> String {
    let parts: Vec<_> =
        path.with_extension("").iter().map(|part| part.to_string_lossy().into_owned()).collect();
    parts.join("/")
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

/// The class of a shape in a label file, or by its name if there is none.
pub(crate) fn label_in(labels: Option<&LabelFile>, name: &str) -> Result<String, Error> {
    labels.map_or_else(|| Ok(label_of(name)), |file| file.label(name))
}

/// The meshes in a folder and its sub-folders, in natural order of their names (`cat2` before `cat10`).
///
/// # Errors
/// [`Error::File`], [`Error::NoShapes`], [`Error::NoLabel`].
pub fn list_shapes(folder: &Path, labels: Option<&LabelFile>) -> Result<Vec<ShapeFile>, Error> {
    let mut shapes = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(current) = folders.pop() {
        let fault = |source| FileError::read(&current, source);
        for entry in std::fs::read_dir(&current).map_err(fault)? {
            let path = entry.map_err(fault)?.path();
            if path.is_dir() {
                folders.push(path);
            } else if is_mesh_path(&path) {
                let name = stem(path.strip_prefix(folder).unwrap_or(&path));
                shapes.push(ShapeFile { label: label_in(labels, &name)?, name, path });
            }
        }
    }
    if shapes.is_empty() {
        return Err(Error::NoShapes { path: folder.to_owned() });
    }
    shapes.sort_by(|a, b| natural_key(&a.name).cmp(&natural_key(&b.name)).then_with(|| a.path.cmp(&b.path)));
    Ok(shapes)
}

/// Splits a name into texts and numbers, so that numbers sort by value.
fn natural_key(name: &str) -> Vec<(String, u64)> {
    let chars: Vec<char> = name.chars().collect();
    let parts = chars.chunk_by(|a, b| a.is_ascii_digit() == b.is_ascii_digit());
    parts
        .map(|part| match (part[0].is_ascii_digit(), part.iter().collect::<String>()) {
            (true, digits) => (String::new(), digits.parse().unwrap_or(u64::MAX)),
            (false, text) => (text, 0),
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_come_from_folders_or_leading_letters() {
        for (name, label) in [("cat0", "cat"), ("cats/sitting1", "cats"), ("0001", "0001"), ("T_rex", "T")] {
            assert_eq!(label_of(name), label);
        }
    }

    #[test]
    fn names_sort_by_number() {
        let mut names = ["cat10", "cat9", "ant1", "cat"];
        names.sort_by_key(|name| natural_key(name));
        assert_eq!(names, ["ant1", "cat", "cat9", "cat10"]);
    }
}
