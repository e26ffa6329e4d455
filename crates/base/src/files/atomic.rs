//! Writing to a temporary file in the same folder and renaming it.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::{NamedTempFile, PersistError, TempDir};

use super::error::FileError;
use super::identity::{FileId, is_at};

/// How the names of temporary files begin.
const PREFIX: &str = ".unfinished-";

/// The temporary files and folders of this process. The lock is held while one is created, renamed or removed, so that the
/// list is always accurate.
static UNFINISHED: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// How often a folder is removed in which other threads still write.
const ATTEMPTS: usize = 100;

fn unfinished() -> MutexGuard<'static, Vec<PathBuf>> {
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Files that must not be replaced.
static INPUTS: Mutex<Option<HashSet<FileId>>> = Mutex::new(None);

/// Keeps a file from being replaced by this process: a result must not take the place of what it was made from, whatever
/// name leads there.
pub fn keep_input(path: &Path) {
    INPUTS.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert_default().extend(FileId::of(path));
}

/// Whether a path leads to a file that [must not be replaced](keep_input).
pub fn is_input(path: &Path) -> bool {
    let inputs = INPUTS.lock().unwrap_or_else(PoisonError::into_inner);
    inputs.as_ref().is_some_and(|inputs| FileId::of(path).is_ok_and(|id| inputs.contains(&id)))
}

/// Removes all temporary files, as the last action of an interrupted program before it exits.
///
/// From then on, every thread that starts or finishes a file blocks forever, so that nothing is left behind.
pub fn abandon_unfinished() {
    let paths = unfinished();
    for path in paths.iter() {
        // A thread may add files to a folder while it is emptied. Nothing more can be done if removal fails.
        let remove = || fs::remove_file(path).or_else(|_| fs::remove_dir_all(path));
        let _ = (0..ATTEMPTS).any(|_| remove().is_ok() || !path.exists());
    }
    std::mem::forget(paths);
}

/// Writes a file sequentially; it replaces `path` once it is complete.
///
/// # Errors
/// [`FileError`] with the path; the previous version stays.
pub fn write_atomically(
    path: &Path,
    content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    Pending::write(path, content)?.publish()
}

/// As [`write_atomically`], but `content` may write anywhere in the file and read what it has written.
///
/// # Errors
/// [`FileError`] with the path; the previous version stays.
pub fn fill_atomically(
    path: &Path,
    content: impl FnOnce(&mut File) -> io::Result<()>,
) -> Result<(), FileError> {
    Pending::fill(path, content)?.publish()
}

/// Writes `bytes` to `path` atomically and creates missing parent folders.
///
/// # Errors
/// [`FileError`] with the path; the previous version stays.
pub fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).map_err(|source| FileError::write(path, source))?;
    }
    write_atomically(path, |out| out.write_all(bytes))
}

/// A temporary file or folder on the list. It is removed on drop.
#[derive(Debug)]
struct Unfinished<T> {
    /// `None` once it is published or dropped.
    inner: Option<T>,
    path: PathBuf,
}

impl<T> Unfinished<T> {
    /// `list` is the locked list.
    fn new(inner: T, path: PathBuf, list: &mut Vec<PathBuf>) -> Self {
        list.push(path.clone());
        Self { inner: Some(inner), path }
    }

    /// Takes it from the list, and does something with it before another one is created, renamed or removed.
    fn finish<R>(&mut self, last: impl FnOnce(T) -> R) -> Option<R> {
        let inner = self.inner.take()?;
        let mut list = unfinished();
        list.retain(|path| *path != self.path);
        Some(last(inner))
    }
}

impl<T> Drop for Unfinished<T> {
    fn drop(&mut self) {
        self.finish(drop);
    }
}

/// A complete file that has not replaced its destination yet.
///
/// Several files that belong together are all written as pending files before the first is published, so that a
/// failure leaves the previous versions untouched.
#[derive(Debug)]
pub struct Pending<'a> {
    file: Unfinished<NamedTempFile>,
    path: &'a Path,
}

impl<'a> Pending<'a> {
    /// Writes a file sequentially; nothing remains after an error.
    ///
    /// # Errors
    /// [`FileError`] with the path.
    pub fn write(
        path: &'a Path,
        content: impl FnOnce(&mut dyn Write) -> io::Result<()>,
    ) -> Result<Self, FileError> {
        Self::fill(path, |file| {
            let mut out = BufWriter::with_capacity(1 << 16, file);
            content(&mut out)?;
            out.flush()
        })
    }

    /// Writes a file in any order; nothing remains after an error.
    fn fill(path: &'a Path, content: impl FnOnce(&mut File) -> io::Result<()>) -> Result<Self, FileError> {
        let written = || {
            if is_input(path) {
                return Err(io::Error::new(io::ErrorKind::ResourceBusy, "it is one of the inputs"));
            }
            let mut file = new_file_in(folder_of(path))?;
            if let Some(file) = &mut file.inner {
                content(file.as_file_mut())?;
                // Otherwise a power failure after the rename could leave the new name with incomplete content.
                file.as_file().sync_all()?;
            }
            Ok(Self { file, path })
        };
        written().map_err(|source| FileError::write(path, source))
    }

    /// Moves the file to its destination and replaces the previous version. Both the content and the new name are on
    /// disk when it returns.
    ///
    /// # Errors
    /// [`FileError`] with the path.
    pub fn publish(self) -> Result<(), FileError> {
        self.publish_by(|file, path| file.persist(path))
    }

    /// As [`publish`](Self::publish), but an existing file stays and is an error.
    ///
    /// # Errors
    /// [`FileError`] with the path.
    pub fn publish_new(self) -> Result<(), FileError> {
        self.publish_by(|file, path| file.persist_noclobber(path))
    }

    fn publish_by(
        mut self,
        rename: impl FnOnce(NamedTempFile, &Path) -> Result<File, PersistError>,
    ) -> Result<(), FileError> {
        let renamed = self.file.finish(|file| rename(file, self.path).map(drop).map_err(|fault| fault.error));
        let published = renamed.unwrap_or(Ok(())).and_then(|()| sync_folder(self.path));
        published.map_err(|source| FileError::write(self.path, source))
    }
}

/// The folder that holds a file.
fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Flushes the folder of a file, and with it the name of the file, to disk.
///
/// # Errors
/// That of the system.
pub fn sync_folder(path: &Path) -> io::Result<()> {
    match cfg!(unix) {
        true => File::open(folder_of(path))?.sync_all(),
        false => Ok(()),
    }
}

/// Creates a file without a name in a folder, for numbers that do not fit into memory. The system removes it when it is
/// closed, however the program ends.
///
/// # Errors
/// [`FileError`] with the folder.
pub fn nameless_in(folder: &Path) -> Result<File, FileError> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    tempfile::tempfile_in(folder).map_err(|source| FileError::write(folder, source))
}

/// A folder for files that only this process reads. It is removed on drop and by [`abandon_unfinished`].
#[derive(Debug)]
pub struct Scratch(Unfinished<TempDir>);

impl Scratch {
    /// Creates an empty folder among the temporary files of the system.
    ///
    /// # Errors
    /// [`FileError`] with the path of the folder for temporary files.
    pub fn new() -> Result<Self, FileError> {
        let mut list = unfinished();
        let place = std::env::temp_dir();
        // Without links, so that `..` below it leads back.
        let folder = place.canonicalize().and_then(tempfile::tempdir_in);
        let folder = folder.map_err(|source| FileError::write(&place, source))?;
        let path = folder.path().to_owned();
        Ok(Self(Unfinished::new(folder, path, &mut list)))
    }

    /// A file name in the folder.
    pub fn file(&self, name: &str) -> PathBuf {
        self.0.path.join(name)
    }
}

/// A temporary file with the permissions of an ordinary new file, locked as long as it is open.
fn new_file_in(folder: &Path) -> io::Result<Unfinished<NamedTempFile>> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    remove_leftovers(folder);
    let mut list = unfinished();
    loop {
        let file = builder.tempfile_in(folder)?;
        // Where files cannot be locked, leftovers are not removed either.
        let is_locked = file.as_file().lock().is_ok();
        // Another program may have taken the file for a leftover before it was locked.
        if !is_locked || is_at(file.as_file(), file.path()) {
            let path = file.path().to_owned();
            return Ok(Unfinished::new(file, path, &mut list));
        }
    }
}

/// Removes what killed programs left in a folder: temporary files that no program has locked. Looks at each folder once.
fn remove_leftovers(folder: &Path) {
    static CLEANED: Mutex<Option<HashSet<PathBuf>>> = Mutex::new(None);
    {
        let mut cleaned = CLEANED.lock().unwrap_or_else(PoisonError::into_inner);
        let place = folder.canonicalize().unwrap_or_else(|_| folder.to_owned());
        if !cleaned.get_or_insert_default().insert(place) {
            return;
        }
    }
    let Ok(entries) = fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let is_leftover = entry.file_name().to_str().is_some_and(|name| name.starts_with(PREFIX))
            && entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_leftover
            && let Ok(file) = File::open(entry.path())
            && file.try_lock().is_ok()
        {
            // It does no harm if it stays.
            let _ = fs::remove_file(entry.path());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_nothing_else_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/er/record.json");
        write_bytes(&path, b"a longer first version").unwrap();
        write_bytes(&path, b"second").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"second");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn leftovers_are_removed_unless_a_program_is_writing_them() {
        let folder = tempfile::tempdir().unwrap();
        let [dead, alive, other] =
            [".unfinished-dead", ".unfinished-alive", "unfinished"].map(|name| folder.path().join(name));
        for path in [&dead, &alive, &other] {
            fs::write(path, "half").unwrap();
        }
        let open = File::open(&alive).unwrap();
        open.lock().unwrap();
        let path = folder.path().join("record.json");
        let pending = Pending::write(&path, |out| out.write_all(b"x")).unwrap();
        assert!(!dead.exists() && alive.exists() && other.exists());
        pending.publish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"x");
    }

    #[test]
    fn a_folder_at_the_destination_is_an_error_that_names_the_path() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        fs::create_dir(&path).unwrap();
        let error = write_bytes(&path, b"x").unwrap_err();
        assert!(error.to_string().starts_with("cannot write ") && error.to_string().contains("record.json"));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "the temporary file is gone");
    }

    #[test]
    fn an_input_is_not_replaced_by_any_of_its_names() {
        let folder = tempfile::tempdir().unwrap();
        let [input, link] = ["mesh.off", "link.off"].map(|name| folder.path().join(name));
        fs::write(&input, "input").unwrap();
        fs::hard_link(&input, &link).unwrap();
        keep_input(&input);
        for name in [&input, &link, &folder.path().join("./mesh.off")] {
            let error = write_bytes(name, b"x").unwrap_err().to_string();
            assert!(error.contains("it is one of the inputs; choose another name"), "{error}");
        }
        assert_eq!(fs::read(&input).unwrap(), b"input");
    }

    #[test]
    fn a_scratch_folder_is_removed() {
        let scratch = Scratch::new().unwrap();
        let file = scratch.file("form.ply");
        write_bytes(&file, b"x").unwrap();
        drop(scratch);
        assert!(!file.exists() && !file.parent().unwrap().exists());
    }

    #[test]
    fn a_nameless_file_leaves_nothing_in_its_folder() {
        let folder = tempfile::tempdir().unwrap();
        let _file = nameless_in(folder.path()).unwrap();
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        let error = nameless_in(&folder.path().join("missing")).unwrap_err();
        assert!(error.to_string().contains("missing"));
    }

    #[test]
    fn a_failed_write_leaves_the_previous_version() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        write_bytes(&path, b"first").unwrap();
        let failed = write_atomically(&path, |out| {
            out.write_all(b"sec")?;
            Err(io::Error::other("disk full"))
        });
        assert!(failed.unwrap_err().to_string().contains("disk full"));
        assert_eq!(fs::read(&path).unwrap(), b"first");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
