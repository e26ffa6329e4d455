//! Where meshes are, as seen from an index: relative to its folder, so that an index moves with its meshes.

use std::path::{Component, Path, PathBuf};

use base::files::FileError;

use mesh_io::{FileSource, without_extension};

use crate::error::Error;
use collection::{Storage, member_of};

/// The folder of an index, without links.
#[derive(Debug, Clone)]
pub(super) struct Home(PathBuf);

impl Home {
    /// # Errors
    /// [`Error::File`] if the folder does not exist.
    pub(super) fn new(index: &Path) -> Result<Self, Error> {
        Ok(Self(canonical(folder_of(index))?))
    }

    /// The text that stands for a path without links: relative to this folder, separated by `/`. A path on another drive
    /// stays as it is.
    fn text(&self, path: &Path) -> String {
        let shared = self.0.components().zip(path.components()).take_while(|(a, b)| a == b).count();
        if shared == 0 {
            return path.to_string_lossy().into_owned();
        }
        let up = self.0.components().skip(shared).map(|_| "..".into());
        let down = path.components().skip(shared).map(|part| part.as_os_str().to_string_lossy());
        up.chain(down).collect::<Vec<_>>().join("/")
    }

    /// The text for a file that is named on its own.
    pub(super) fn file_text(&self, file: &Path) -> String {
        absolute(file).map_or_else(|_| slashed(file), |path| self.text(&path))
    }

    /// The text for a path that another index states.
    pub(super) fn text_of(&self, index: &Path, stored: &str) -> String {
        let path = mesh_path(index, stored);
        // Without the folder of the mesh, the text says no less than before.
        match path.file_name().is_some() && (folder_of(&path).exists() || member_of(&path).is_some()) {
            true => self.file_text(&path),
            false => stored.to_owned(),
        }
    }
}

/// A file's absolute path: without links in the folder, or the archive, that it is in.
pub(super) fn absolute(file: &Path) -> Result<PathBuf, Error> {
    let start = folder_of(file);
    for above in start.ancestors() {
        let above = if above.as_os_str().is_empty() { Path::new(".") } else { above };
        if let Ok(canonical) = above.canonicalize() {
            let below = file.strip_prefix(above).unwrap_or(file);
            return Ok(canonical.join(below));
        }
    }
    Ok(canonical(start)?.join(file.file_name().unwrap_or_default()))
}

/// A folder, an archive or a list of meshes, as seen from an index.
#[derive(Debug, Clone)]
pub(super) struct Root<'a> {
    /// As it was named.
    pub(super) given: &'a Path,
    canonical: PathBuf,
    home: &'a Home,
    is_archive: bool,
}

impl<'a> Root<'a> {
    /// # Errors
    /// [`Error::File`] if the folder does not exist.
    pub(super) fn new(given: &'a Path, home: &'a Home) -> Result<Self, Error> {
        Ok(Self { given, canonical: canonical(given)?, home, is_archive: given.is_file() })
    }

    /// The text for a file below this folder, or named by this list. It does not depend on how the folder was named.
    pub(super) fn text(&self, file: &Path) -> String {
        match file.strip_prefix(self.given) {
            Ok(below) => self.home.text(&self.canonical.join(below)),
            Err(_) => self.home.file_text(file),
        }
    }

    /// Whether a shape with this name and path came from this folder.
    pub(super) fn contains_source(&self, id: &str, stored: &str) -> bool {
        let below = match self.home.text(&self.canonical).as_str() {
            "" => Some(stored).filter(|stored| !stored.starts_with("../") && !stored.starts_with('/')),
            folder => stored.strip_prefix(folder).and_then(|rest| rest.strip_prefix('/')),
        };
        // The name may hold the extension, if several files differ in nothing else, and folders around this one, if another
        // place has the name without. Folders around all meshes of an archive are no part of the names.
        below.is_some_and(|below| {
            let stem = slashed(&without_extension(Path::new(below)));
            let is_named = |name: &str| name == id || is_end(name, id) || self.is_archive && is_end(id, name);
            is_named(below) || is_named(&stem)
        })
    }
}

/// Whether a name has another one at its end, below a folder.
pub(super) fn is_end(end: &str, name: &str) -> bool {
    name.strip_suffix(end).is_some_and(|rest| rest.ends_with('/'))
}

/// The path of a mesh that an index states as `stored`, for programs to open and people to read.
///
/// Paths are relative to the folder of the index.
///
/// ```
/// use std::path::Path;
///
/// let path = canonform::library::mesh_path(Path::new("work/shapes.canonform"), "../meshes/cat0.off");
/// assert_eq!(path, Path::new("meshes/cat0.off"));
/// ```
pub fn mesh_path(index: &Path, stored: &str) -> PathBuf {
    let joined = index.parent().unwrap_or(Path::new("")).join(stored);
    let tidy = without_detours(&joined);
    // Leaving out `x/..` is wrong where `x` is a link.
    if !Storage.holds(&tidy) && Storage.holds(&joined) { joined } else { tidy }
}

/// A path without `.` and without `x/..`.
fn without_detours(path: &Path) -> PathBuf {
    let mut parts: Vec<Component<'_>> = Vec::new();
    for part in path.components() {
        match (part, parts.last()) {
            (Component::CurDir, _) => {}
            (Component::ParentDir, Some(Component::Normal(_))) => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    parts.iter().collect()
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

pub(super) fn canonical(folder: &Path) -> Result<PathBuf, Error> {
    Ok(folder.canonicalize().map_err(|source| FileError::read(folder, source))?)
}

fn slashed(path: &Path) -> String {
    let parts = without_detours(path);
    parts.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/")
}
