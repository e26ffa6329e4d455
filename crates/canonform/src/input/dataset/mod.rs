//! A folder of meshes as a labelled dataset.

mod labels;
mod shape_file;
mod walk;

use std::collections::BTreeMap;
use std::path::Path;

use crate::error::Error;
use labels::joined;
use walk::Walk;

pub use labels::{LabelFile, label_of};
pub(crate) use labels::{drop_single_class, label_in};
pub use shape_file::ShapeFile;
pub use walk::{SkipKind, Skipped};

/// What a folder holds.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Dataset {
    /// The meshes, in natural order of their names (`cat2` before `cat10`).
    pub shapes: Vec<ShapeFile>,
    /// Everything else, in the order of the paths.
    pub skipped: Vec<Skipped>,
}

impl Dataset {
    /// The meshes in a folder and its sub-folders. Links are followed, but no file or folder is found twice through them.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::NoShapes`].
    pub fn read(folder: &Path, labels: Option<&LabelFile>) -> Result<Self, Error> {
        let Walk { meshes, skipped, .. } = Walk::below(folder)?;
        let mut shapes: Vec<ShapeFile> = meshes
            .into_iter()
            .map(|path| {
                let name = joined(&path.strip_prefix(folder).unwrap_or(&path).with_extension(""));
                ShapeFile { label: label_in(labels, &name, Some(&path)), name, path }
            })
            .collect();
        if shapes.is_empty() {
            return Err(Error::NoShapes { path: folder.to_owned() });
        }
        shapes.sort_by(|a, b| {
            natural_key(&a.name).cmp(&natural_key(&b.name)).then_with(|| a.path.cmp(&b.path))
        });
        Ok(Self { shapes, skipped })
    }
}

/// How many things were skipped for each reason.
pub(crate) fn count_skipped(skipped: &[Skipped]) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    skipped.iter().for_each(|skipped| *counts.entry(skipped.kind.to_string()).or_insert(0) += 1);
    counts
}

/// The meshes in a folder and its sub-folders, in natural order of their names; see [`Dataset::read`].
///
/// # Errors
/// [`Error::File`], [`Error::NoShapes`].
pub fn list_shapes(folder: &Path, labels: Option<&LabelFile>) -> Result<Vec<ShapeFile>, Error> {
    Ok(Dataset::read(folder, labels)?.shapes)
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
