//! The files below a folder, each once, whatever links and special files there are.

use std::collections::HashSet;
use std::fmt;
use std::fs;
use std::path::{Path, PathBuf};

use base::files::{FileError, FileId};
use mesh_io::{extension, files_of, is_mesh_path};

use crate::error::CollectionError;
use crate::storage::{has_members, is_archive_like};

/// Something in a folder that is not a shape.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Skipped {
    /// Where it is.
    pub path: PathBuf,
    /// Why it was skipped.
    pub kind: SkipKind,
}

/// Why something in a folder was skipped.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum SkipKind {
    /// A file whose extension is not one of meshes; empty if it has none.
    Extension(String),
    /// Neither a file nor a folder: a pipe, a socket or a device.
    Special,
    /// A mesh or a folder whose name is not UTF-8, so that the name cannot be stored.
    NotUtf8,
    /// The name of a member that leads out of its archive.
    UnsafeName,
    /// A link to a file or a folder that is found without it, a second line of a list for the same file, or the first of two members of
    /// one name.
    Repeated,
    /// What macOS stores beside a file, under its name after `._`.
    AppleDouble,
    /// A link that leads nowhere.
    BrokenLink,
    /// A sub-folder or an archive that cannot be read.
    Unreadable,
    /// An archive whose members are not read: of a kind that is unknown, compressed as a whole, or in another archive.
    UnreadArchive(String),
    /// A sub-folder that duplicates were moved into.
    MovedAway,
}

/// The file in a folder that duplicates were moved into. Such a folder is no part of the collection around it.
pub const MOVES: &str = "canonform-moved.jsonl";

impl SkipKind {
    /// Of a file that is no mesh.
    pub(super) fn of_file(path: &Path) -> Self {
        match is_archive_like(path) {
            true => Self::UnreadArchive(extension(path)),
            false => Self::Extension(extension(path)),
        }
    }

    /// Whether users expect it: files that are not meshes, and what they moved.
    pub fn is_expected(&self) -> bool {
        matches!(self, Self::Extension(_) | Self::AppleDouble | Self::MovedAway)
    }
}

impl fmt::Display for SkipKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Extension(extension) if extension.is_empty() => f.write_str("no extension"),
            Self::Extension(extension) => write!(f, ".{extension}"),
            Self::Special => f.write_str("special file"),
            Self::NotUtf8 => f.write_str("name is not UTF-8"),
            Self::UnsafeName => f.write_str("name leads out of the archive"),
            Self::Repeated => f.write_str("found already under this or another name"),
            Self::AppleDouble => f.write_str("._ file of macOS"),
            Self::BrokenLink => f.write_str("broken link"),
            Self::Unreadable => f.write_str("unreadable folder or archive"),
            Self::UnreadArchive(extension) => write!(f, ".{extension} archive that is not looked into"),
            Self::MovedAway => f.write_str("folder of moved duplicates"),
        }
    }
}

/// What is below a folder.
#[derive(Debug, Default)]
pub(super) struct Walk {
    /// Paths of meshes and of archives that may hold some, in no particular order.
    pub(super) files: Vec<PathBuf>,
    pub(super) skipped: Vec<Skipped>,
    /// Folders and files found so far.
    seen: HashSet<FileId>,
    folders: Vec<PathBuf>,
    links: Vec<PathBuf>,
}

impl Walk {
    /// Everything below `root`. Links are followed once, after all that is found without them; so no loop of links goes on
    /// for ever, and what is found does not depend on the order in which the system lists names.
    ///
    /// # Errors
    /// [`CollectionError::File`] if `root` cannot be read.
    pub(super) fn below(root: &Path) -> Result<Self, CollectionError> {
        let cannot_read = |source| CollectionError::from(FileError::read(root, source));
        let mut walk = Self::default();
        // A link to a folder around the root would lead back to it.
        let place = root.canonicalize().map_err(cannot_read)?;
        for folder in place.ancestors() {
            walk.seen.extend(FileId::of(folder));
        }
        walk.read_folder(root).map_err(cannot_read)?;
        loop {
            while let Some(folder) = walk.folders.pop() {
                if walk.read_folder(&folder).is_err() {
                    walk.skip(folder, SkipKind::Unreadable);
                }
            }
            if walk.links.is_empty() {
                return Ok(walk);
            }
            let mut links = std::mem::take(&mut walk.links);
            links.sort();
            links.into_iter().for_each(|link| walk.follow(link));
        }
    }

    pub(super) fn skip(&mut self, path: PathBuf, kind: SkipKind) {
        self.skipped.push(Skipped { path, kind });
    }

    fn read_folder(&mut self, folder: &Path) -> std::io::Result<()> {
        for entry in fs::read_dir(folder)? {
            let entry = entry?;
            let (path, kind) = (entry.path(), entry.file_type()?);
            if kind.is_symlink() {
                self.links.push(path);
            } else {
                self.take(path, kind);
            }
        }
        Ok(())
    }

    fn follow(&mut self, link: PathBuf) {
        match fs::metadata(&link) {
            Ok(target) => self.take(link, target.file_type()),
            Err(_) => self.skip(link, SkipKind::BrokenLink),
        }
    }

    /// Sorts a file or folder in.
    fn take(&mut self, path: PathBuf, kind: fs::FileType) {
        if kind.is_file() && is_apple_double(&path) {
            return self.skip(path, SkipKind::AppleDouble);
        }
        let is_wanted = kind.is_file() && (is_mesh_path(&path) || has_members(&path));
        if !kind.is_dir() && !is_wanted {
            return match kind.is_file() {
                false => self.skip(path, SkipKind::Special),
                // The other half of a pair is no file of its own.
                true if files_of(&path).len() > 1 => {}
                true => {
                    let kind = SkipKind::of_file(&path);
                    self.skip(path, kind);
                }
            };
        }
        if path.file_name().is_some_and(|name| name.to_str().is_none()) {
            return self.skip(path, SkipKind::NotUtf8);
        }
        if path.join(MOVES).exists() {
            return self.skip(path, SkipKind::MovedAway);
        }
        match FileId::of(&path).map(|id| self.seen.insert(id)) {
            Err(_) => self.skip(path, SkipKind::BrokenLink),
            Ok(false) if is_link(&path) => self.skip(path, SkipKind::Repeated),
            Ok(_) if is_wanted => self.files.push(path),
            Ok(_) => self.folders.push(path),
        }
    }
}

/// Whether a name is that of what macOS stores beside a file, such as `._cat.off` beside `cat.off`.
pub(crate) fn is_apple_double(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.as_encoded_bytes().starts_with(b"._"))
}

/// Hard links are files of their own.
fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|about| about.file_type().is_symlink())
}
