//! The journal of moves: one line of JSON for every mesh.

use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use base::files::{FileError, sync_folder, write_bytes};
use collection::MOVES;
use serde::{Deserialize, Serialize};

use super::report::{MoveReport, NotMoved};
use crate::error::Error;

/// How a line begins.
const START: &str = "{\"files\":[";

/// The files of a mesh: where they were, and where they are, as seen from the folder of the journal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Line {
    pub(super) files: Vec<(PathBuf, PathBuf)>,
}

impl Line {
    fn text(&self) -> String {
        serde_json::json!(self).to_string() + "\n"
    }
}

/// An open journal, locked against other programs.
pub(super) struct Journal {
    pub(super) path: PathBuf,
    pub(super) folder: PathBuf,
    file: File,
    /// Bytes before the last line.
    before: u64,
    pub(super) lines: Vec<Line>,
}

impl Journal {
    /// Opens or makes the journal of a folder, and takes back a mesh of which an interrupted program has moved a part.
    pub(super) fn start(place: &Path) -> Result<Self, Error> {
        fs::create_dir_all(place).map_err(|source| FileError::write(place, source))?;
        let mut journal = Self::open(&place.join(MOVES), true)?;
        let folder = journal.folder.clone();
        let is_left = |(from, to): &(PathBuf, PathBuf)| {
            let is_there = fs::symlink_metadata(folder.join(to)).is_ok_and(|about| about.len() > 0);
            !is_there && fs::symlink_metadata(from).is_ok()
        };
        if let Some(last) = journal.lines.pop_if(|last| last.files.iter().any(is_left)) {
            match last.back(&folder, &mut MoveReport::default()) {
                true => journal.take_back()?,
                false => journal.lines.push(last),
            }
        }
        Ok(journal)
    }

    /// Opens a journal, which may be a new one.
    pub(super) fn open(path: &Path, is_new: bool) -> Result<Self, Error> {
        let cannot_read = |source| FileError::read(path, source);
        let open = OpenOptions::new().read(true).append(true).create(is_new).open(path);
        let mut file = open.map_err(cannot_read)?;
        let refused = |what: &str| Error::refused(format!("{}: {what}", path.display()));
        file.try_lock().map_err(|_| refused("another program is moving files; wait for its end"))?;
        let mut text = String::new();
        file.read_to_string(&mut text).map_err(cannot_read)?;
        // A program was interrupted while it wrote what is behind the last line, before anything was moved.
        let (whole, rest) = text.split_at(text.rfind('\n').map_or(0, |end| end + 1));
        let lines = whole.lines().map(serde_json::from_str).collect::<Result<Vec<Line>, _>>().ok();
        let lines = lines.filter(|lines| is_new || !lines.is_empty());
        let is_start = START.starts_with(rest) || rest.starts_with(START);
        let lines = lines.filter(|_| is_start).ok_or_else(|| refused("this is no journal of moved files"))?;
        file.set_len(whole.len() as u64).and_then(|()| sync_folder(path)).map_err(cannot_read)?;
        let before = whole.trim_end().rfind('\n').map_or(0, |end| end + 1) as u64;
        let path = path.canonicalize().map_err(cannot_read)?;
        let folder = path.parent().unwrap_or(Path::new("/")).to_owned();
        Ok(Self { path, folder, file, before, lines })
    }

    /// Where files below `root` go: to their own names below the folder, or below a numbered folder in it.
    pub(super) fn line(&self, files: Vec<PathBuf>, root: &Path) -> Line {
        let below = |file: &Path| file.strip_prefix(root).unwrap_or(file).to_owned();
        let is_free = |to: &Path| {
            let found = fs::symlink_metadata(self.folder.join(to));
            found.is_err_and(|fault| fault.kind() == ErrorKind::NotFound)
        };
        let mut prefix = PathBuf::new();
        for number in 2_u64.. {
            if files.iter().all(|file| is_free(&prefix.join(below(file)))) {
                break;
            }
            prefix = number.to_string().into();
        }
        let to = |file: PathBuf| {
            let to = prefix.join(below(&file));
            (file, to)
        };
        Line { files: files.into_iter().map(to).collect() }
    }

    /// Appends a line, which is on the disk when this returns.
    pub(super) fn append(&mut self, line: &Line) -> Result<(), Error> {
        let mut append = || {
            self.before = self.file.metadata()?.len();
            self.file.write_all(line.text().as_bytes())?;
            self.file.sync_all()
        };
        Ok(append().map_err(|source| FileError::write(&self.path, source))?)
    }

    /// Removes the last line.
    pub(super) fn take_back(&mut self) -> Result<(), Error> {
        let done = self.file.set_len(self.before).and_then(|()| self.file.sync_all());
        Ok(done.map_err(|source| FileError::write(&self.path, source))?)
    }

    /// Keeps only these lines; without any, removes the journal, and folders that are empty. Returns its path if it stays.
    pub(super) fn finish(self, lines: &[Line]) -> Result<Option<PathBuf>, Error> {
        if lines.is_empty() {
            fs::remove_file(&self.path).map_err(|source| FileError::write(&self.path, source))?;
            remove_empty(&self.folder);
            return Ok(None);
        }
        let text: String = lines.iter().map(Line::text).collect();
        write_bytes(&self.path, text.as_bytes())?;
        Ok(Some(self.path))
    }
}

/// Removes folders that hold nothing but such folders.
fn remove_empty(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
            remove_empty(&entry.path());
        }
    }
    // A folder that holds something cannot be removed.
    let _ = fs::remove_dir(folder);
}

impl Line {
    /// Moves the files of a line to where it says.
    pub(super) fn there(&self, folder: &Path, report: &mut MoveReport) -> io::Result<()> {
        let n_before = report.moved.len();
        for (from, to) in &self.files {
            let to = folder.join(to);
            move_file(from, &to).inspect_err(|_| report.moved.truncate(n_before))?;
            report.moved.push([from.clone(), to]);
        }
        Ok(())
    }

    /// Puts the files of a line back, those that were moved. Returns whether nothing is left to do.
    pub(super) fn back(&self, folder: &Path, report: &mut MoveReport) -> bool {
        let mut is_done = true;
        for (from, to) in self.files.iter().rev() {
            let to = folder.join(to);
            let size = |path: &Path| fs::symlink_metadata(path).ok().map(|about| about.len());
            // What is empty holds a name, where a move was interrupted.
            let why = match (size(from), size(&to)) {
                (Some(_), None) => continue,
                (Some(_), Some(0)) => fs::remove_file(&to).err().map(|fault| fault.to_string()),
                (Some(0), Some(_)) => fs::rename(&to, from).err().map(|fault| fault.to_string()),
                (None, Some(_)) => move_file(&to, from).err().map(|fault| fault.to_string()),
                (Some(_), Some(_)) => Some(format!("another file is now {}", from.display())),
                (None, None) => {
                    report.not_moved.push(NotMoved { path: to, why: "it is gone".into() });
                    continue;
                }
            };
            is_done &= why.is_none();
            match why {
                None => report.moved.push([to, from.clone()]),
                Some(why) => report.not_moved.push(NotMoved { path: to, why }),
            }
        }
        is_done
    }
}

/// Gives a file a new name, which nothing else has.
fn move_file(from: &Path, to: &Path) -> io::Result<()> {
    to.parent().map_or(Ok(()), fs::create_dir_all)?;
    // An empty file holds the name, so that the file takes no place but its own.
    fs::File::create_new(to)?;
    fs::rename(from, to).inspect_err(|_| drop(fs::remove_file(to)))
}
