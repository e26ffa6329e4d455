//! What moving files has done.

use std::path::PathBuf;

use serde::Serialize;

/// What was moved, there or back, and what was not.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MoveReport {
    /// Where the files were, and where they are now: all files of a mesh, one mesh after the other.
    pub moved: Vec<[PathBuf; 2]>,
    /// What stays where it is.
    pub not_moved: Vec<NotMoved>,
    /// The file by which [`undo_moves`](super::undo_moves) puts everything back; `None` if there is nothing to put back.
    pub journal: Option<PathBuf>,
}

/// A file that was not moved.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NotMoved {
    /// The file.
    pub path: PathBuf,
    /// Why, as the end of a sentence.
    pub why: String,
}
