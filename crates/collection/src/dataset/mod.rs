//! A folder, an archive or a list of meshes as a labelled dataset.

mod classes;
mod labels;
mod shape_file;
mod walk;

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use mesh_io::{extension, files_in, is_mesh_path, mesh_files, without_extension};

use crate::error::CollectionError;
use crate::storage::{Container, Storage, is_unread_archive, open_archive, read_list};
use walk::Walk;

pub(crate) use labels::joined;

pub use classes::{
    LabelOrigin, LabelSource, drop_single_class, is_suggested, label_of, label_shapes, n_classes,
};
pub use labels::{LabelFile, UnusedLabel};
pub use shape_file::ShapeFile;
pub(crate) use walk::is_apple_double;
pub use walk::{MOVES, SkipKind, Skipped};

/// What a folder, an archive or a list holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Dataset {
    /// The meshes, in natural order of their names (`cat2` before `cat10`).
    pub shapes: Vec<ShapeFile>,
    /// Where their classes come from.
    pub labelled_by: LabelOrigin,
    /// Everything else, in the order of the paths.
    pub skipped: Vec<Skipped>,
}

impl Dataset {
    /// The meshes of a dataset, whose names are paths below it without extensions:
    ///
    /// * a folder and its sub-folders, and the `.zip` and `.tar` archives in them. Links are followed, but no file or folder is
    ///   found twice through them;
    /// * an archive, `.zip`, `.tar`, `.tar.gz` or `.tgz`. Folders around all of its meshes are left out of the names;
    /// * a `.parquet` file with a mesh in every row: the column `bytes` holds the content of a file, `id` its name, `format`
    ///   its extension and `label` its class;
    /// * a `.txt` or `.list` file with a path in every line, relative to its folder. Folders around all of its meshes are left
    ///   out of the names.
    ///
    /// Without `labels`, classes are those that a Parquet file states; else sub-folders beside each other, if at least two hold at
    /// least two meshes each and none lies in another; else the leading letters of file names, if at least two share them.
    ///
    /// # Errors
    /// [`CollectionError::File`] and [`CollectionError::Mesh`] if it cannot be read, [`CollectionError::NotADataset`],
    /// [`CollectionError::UnreadArchive`], [`CollectionError::BadLine`], [`CollectionError::NoShapes`].
    pub fn read(path: &Path, labels: Option<&LabelSource>) -> Result<Self, CollectionError> {
        let found = match Container::of(path) {
            Some(Container::List) => Found::in_list(path)?,
            Some(Container::Zip | Container::Tar | Container::Parquet) => Found::in_archive(path)?,
            None if path.is_file() && is_unread_archive(path) => {
                return Err(CollectionError::UnreadArchive { path: path.to_owned() });
            }
            None if path.is_file() => return Err(CollectionError::NotADataset { path: path.to_owned() }),
            Some(Container::Folder) | None => Found::in_folder(path)?,
        };
        let mut shapes = found.shapes;
        if shapes.is_empty() {
            let unexpected = found.skipped.iter().filter(|skipped| !skipped.kind.is_expected());
            return Err(CollectionError::NoShapes {
                path: path.to_owned(),
                skipped: count_skipped(unexpected),
            });
        }
        for shape in &mut shapes {
            let below = shape.path.strip_prefix(&found.root).unwrap_or(&shape.path);
            shape.name = joined(&without_extension(below));
        }
        shapes.sort_by(|a, b| {
            natural_key(&a.name).cmp(&natural_key(&b.name)).then_with(|| a.path.cmp(&b.path))
        });
        let labelled_by = classes::label_shapes(&mut shapes, labels);
        Ok(Self { shapes, labelled_by, skipped: found.skipped })
    }
}

/// Meshes before they have names.
struct Found {
    /// The folder that names are relative to.
    root: PathBuf,
    shapes: Vec<ShapeFile>,
    skipped: Vec<Skipped>,
}

fn nameless(path: PathBuf, label: String) -> ShapeFile {
    ShapeFile { name: String::new(), label, path }
}

impl Found {
    fn in_folder(folder: &Path) -> Result<Self, CollectionError> {
        let Walk { files, mut skipped, .. } = Walk::below(folder)?;
        let mut shapes = Vec::new();
        for path in files {
            if is_mesh_path(&path) {
                shapes.push(nameless(path, String::new()));
                continue;
            }
            match Self::in_archive(&path) {
                // Of an archive without meshes, only archives in it may matter.
                Ok(mut found) if found.shapes.is_empty() => {
                    found.skipped.retain(|skipped| matches!(skipped.kind, SkipKind::UnreadArchive(_)));
                    if found.skipped.is_empty() {
                        skipped.push(Skipped { kind: SkipKind::Extension(extension(&path)), path });
                    }
                    skipped.extend(found.skipped);
                }
                Ok(found) => {
                    shapes.extend(found.shapes);
                    skipped.extend(found.skipped);
                }
                Err(_) => skipped.push(Skipped { path, kind: SkipKind::Unreadable }),
            }
        }
        skipped.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Self { root: folder.to_owned(), shapes, skipped })
    }

    fn in_archive(path: &Path) -> Result<Self, CollectionError> {
        let archive = open_archive(path)?;
        let skip = |name: &str, kind| Skipped { path: path.join(name), kind };
        let mut skipped: Vec<Skipped> =
            archive.skipped.iter().map(|(name, kind)| skip(name, kind.clone())).collect();
        let mut shapes = Vec::new();
        for (name, member) in archive.members() {
            let below = Path::new(name);
            if is_mesh_path(below) {
                shapes.push(nameless(path.join(below), member.label.clone()));
            } else if files_in(&path.join(below), &Storage).len() < 2 {
                skipped.push(skip(name, SkipKind::of_file(below)));
            }
        }
        skipped.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Self { root: common_folder(&shapes, path), shapes, skipped })
    }

    fn in_list(list: &Path) -> Result<Self, CollectionError> {
        let (mut shapes, mut skipped) = (Vec::new(), Vec::new());
        let mut seen = HashSet::new();
        for (path, line) in read_list(list)? {
            if !is_mesh_path(&path) {
                let what = format!("{} is not a mesh; a mesh is {}", path.display(), mesh_files());
                return Err(CollectionError::BadLine { path: list.to_owned(), line, what });
            }
            match seen.insert(path.clone()) {
                true => shapes.push(nameless(path, String::new())),
                false => skipped.push(Skipped { path, kind: SkipKind::Repeated }),
            }
        }
        let folder = list.parent().unwrap_or(Path::new(""));
        Ok(Self { root: common_folder(&shapes, folder), shapes, skipped })
    }
}

/// The innermost folder that contains all meshes.
fn common_folder(shapes: &[ShapeFile], otherwise: &Path) -> PathBuf {
    let mut folders = shapes.iter().filter_map(|shape| shape.path.parent());
    let Some(mut common) = folders.next() else { return otherwise.to_owned() };
    for folder in folders {
        while !folder.starts_with(common) {
            match common.parent() {
                Some(above) => common = above,
                None => return PathBuf::new(),
            }
        }
    }
    common.to_owned()
}

/// How many things were skipped for each reason.
pub fn count_skipped<'a>(skipped: impl IntoIterator<Item = &'a Skipped>) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    skipped.into_iter().for_each(|skipped| *counts.entry(skipped.kind.to_string()).or_insert(0) += 1);
    counts
}

/// The meshes of a folder, an archive or a list, in natural order of their names; see [`Dataset::read`].
///
/// # Errors
/// [`CollectionError::File`], [`CollectionError::NoShapes`].
pub fn list_shapes(path: &Path, labels: Option<&LabelSource>) -> Result<Vec<ShapeFile>, CollectionError> {
    Ok(Dataset::read(path, labels)?.shapes)
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

    #[cfg(unix)]
    #[test]
    fn links_are_followed_once_and_special_files_are_skipped() {
        use std::ffi::OsStr;
        use std::fs;
        use std::os::unix::ffi::OsStrExt;
        use std::os::unix::fs::symlink;
        use std::os::unix::net::UnixListener;

        let place = tempfile::tempdir().unwrap();
        let folder = place.path().join("meshes");
        let at = |name: &str| folder.join(name);
        fs::create_dir_all(at("sub")).unwrap();
        fs::create_dir(place.path().join("far")).unwrap();
        for path in
            [at("a.1.off"), at("sub/b.off"), place.path().join("far/c.off"), place.path().join("d.off")]
        {
            fs::write(path, "OFF").unwrap();
        }
        fs::write(at("notes.txt"), "").unwrap();
        fs::write(at("pair.vert"), "").unwrap();
        fs::write(at("pair.tri"), "").unwrap();
        fs::write(at("LICENSE"), "").unwrap();
        // Two loops, links to what is there anyway, links to what is elsewhere.
        symlink(".", at("self")).unwrap();
        symlink("..", at("sub/up")).unwrap();
        symlink("../..", at("sub/out")).unwrap();
        symlink("sub/b.off", at("again.off")).unwrap();
        symlink("../far", at("other")).unwrap();
        symlink("../far", at("other2")).unwrap();
        symlink("../d.off", at("linked.off")).unwrap();
        symlink("nowhere", at("broken.off")).unwrap();
        symlink("/dev/zero", at("endless.off")).unwrap();
        let _socket = UnixListener::bind(at("pipe.off")).unwrap();
        for name in [&b"\xff1.off"[..], b"\xff2.off", b"\xfe"] {
            fs::write(folder.join(OsStr::from_bytes(name)), "OFF").unwrap();
        }
        let dataset = Dataset::read(&folder, None).unwrap();
        let names: Vec<_> = dataset.shapes.iter().map(|shape| shape.name.as_str()).collect();
        assert_eq!(names, ["a.1", "linked", "other/c", "pair", "sub/b"]);
        let counts = count_skipped(&dataset.skipped);
        let expected = [
            (".txt", 1),
            ("broken link", 1),
            ("found already under this or another name", 5),
            ("name is not UTF-8", 2),
            ("no extension", 2),
            ("special file", 2),
        ];
        let counts: Vec<_> = counts.iter().map(|(kind, n)| (kind.as_str(), *n)).collect();
        assert_eq!(counts, expected);
    }
}
