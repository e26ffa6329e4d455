//! A folder, an archive or a list of meshes as a labelled dataset.

mod classes;
mod labels;
mod shape_file;
mod walk;

use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};

use mesh::io::{extension, files_in, is_mesh_path, mesh_files, without_extension};

use crate::error::CollectionError;
use crate::storage::{Container, ListedPath, Storage, open_archive, read_list};
use labels::joined;
use walk::Walk;

pub use classes::{LabelOrigin, LabelSource, drop_single_class, label_of, label_shapes, n_classes};
pub use labels::{LabelFile, UnusedLabel};
pub use shape_file::ShapeFile;
pub use walk::{SkipKind, Skipped};

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
    /// * a folder and its sub-folders. Links are followed, but no file or folder is found twice through them;
    /// * an archive, `.zip`, `.tar`, `.tar.gz` or `.tgz`. Folders around all of its meshes are left out of the names;
    /// * a `.parquet` file with a mesh in every row: the column `bytes` holds the content of a file, `id` its name, `format`
    ///   its extension and `label` its class;
    /// * a `.txt` or `.list` file with a path in every line, relative to its folder. Folders around all of its meshes are left
    ///   out of the names.
    ///
    /// Without `labels`, classes are those that a Parquet file states; else the sub-folders, if at least two hold at least
    /// two meshes each and none lies in another; else the leading letters of file names, if at least two share them.
    ///
    /// # Errors
    /// [`CollectionError::File`] and [`CollectionError::Mesh`] if it cannot be read, [`CollectionError::BadLine`], [`CollectionError::NoShapes`].
    pub fn read(path: &Path, labels: Option<&LabelSource>) -> Result<Self, CollectionError> {
        let found = match Container::of(path) {
            Some(Container::List) => Found::in_list(path)?,
            Some(Container::Zip | Container::Tar | Container::Parquet) => Found::in_archive(path)?,
            Some(Container::Folder) | None => Found::in_folder(path)?,
        };
        let mut shapes: Vec<ShapeFile> = found
            .meshes
            .into_iter()
            .map(|mesh| {
                let name =
                    joined(&without_extension(mesh.path.strip_prefix(&found.root).unwrap_or(&mesh.path)));
                ShapeFile { label: mesh.label.unwrap_or_default(), name, path: mesh.path }
            })
            .collect();
        if shapes.is_empty() {
            return Err(CollectionError::NoShapes { path: path.to_owned() });
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
    meshes: Vec<FoundMesh>,
    skipped: Vec<Skipped>,
}

struct FoundMesh {
    path: PathBuf,
    /// Its class, if the dataset states one.
    label: Option<String>,
}

impl Found {
    fn in_folder(folder: &Path) -> Result<Self, CollectionError> {
        let Walk { meshes, skipped, .. } = Walk::below(folder)?;
        let meshes = meshes.into_iter().map(|path| FoundMesh { path, label: None }).collect();
        Ok(Self { root: folder.to_owned(), meshes, skipped })
    }

    fn in_archive(path: &Path) -> Result<Self, CollectionError> {
        let archive = open_archive(path)?;
        let skip = |name: &str, kind| Skipped { path: path.join(name), kind };
        let mut skipped: Vec<Skipped> =
            archive.skipped.iter().map(|(name, kind)| skip(name, kind.clone())).collect();
        let mut meshes = Vec::new();
        for (name, member) in archive.members() {
            let below = Path::new(name);
            if is_mesh_path(below) {
                meshes.push(FoundMesh { path: path.join(below), label: member.label.clone() });
            } else if files_in(&path.join(below), &Storage).len() < 2 {
                skipped.push(skip(name, SkipKind::Extension(extension(below))));
            }
        }
        skipped.sort_by(|a, b| a.path.cmp(&b.path));
        Ok(Self { root: common_folder(&meshes, path), meshes, skipped })
    }

    fn in_list(list: &Path) -> Result<Self, CollectionError> {
        let (mut meshes, mut skipped) = (Vec::new(), Vec::new());
        let mut seen = HashSet::new();
        for ListedPath { path, line } in read_list(list)? {
            if !is_mesh_path(&path) {
                let what = format!("{} is not a mesh; a mesh is {}", path.display(), mesh_files());
                return Err(CollectionError::BadLine { path: list.to_owned(), line, what });
            }
            match seen.insert(path.clone()) {
                true => meshes.push(FoundMesh { path, label: None }),
                false => skipped.push(Skipped { path, kind: SkipKind::Repeated }),
            }
        }
        let folder = list.parent().unwrap_or(Path::new(""));
        Ok(Self { root: common_folder(&meshes, folder), meshes, skipped })
    }
}

/// The innermost folder that contains all meshes.
fn common_folder(meshes: &[FoundMesh], otherwise: &Path) -> PathBuf {
    let mut folders = meshes.iter().filter_map(|mesh| mesh.path.parent());
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
pub fn count_skipped(skipped: &[Skipped]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    skipped.iter().for_each(|skipped| *counts.entry(skipped.kind.to_string()).or_insert(0) += 1);
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

    #[test]
    fn names_sort_by_number() {
        let mut names = ["cat10", "cat9", "ant1", "cat"];
        names.sort_by_key(|name| natural_key(name));
        assert_eq!(names, ["ant1", "cat", "cat9", "cat10"]);
    }

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
            ("link to something found already", 5),
            ("name is not UTF-8", 2),
            ("no extension", 2),
            ("special file", 2),
        ];
        let counts: Vec<_> = counts.iter().map(|(kind, n)| (kind.as_str(), *n)).collect();
        assert_eq!(counts, expected);
    }
}
