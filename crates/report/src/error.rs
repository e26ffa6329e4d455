//! What can go wrong between a record and a picture.

use std::path::PathBuf;

/// Errors of reading records and of drawing and writing figures.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be read or written; nothing of it is left behind.
    #[error(transparent)]
    File(#[from] files::FileError),
    /// A picture could not be drawn or written.
    #[error(transparent)]
    View(#[from] view::ViewError),
    /// A file is not the record it should be.
    #[error("{}: is not a record this version reads: {source}; run the experiment again", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Where and why reading stopped.
        source: serde_json::Error,
    },
    /// A record contradicts itself.
    #[error(
        "{what} has {found} entries where {expected} are needed, one for each {unit}; run the experiment again"
    )]
    Shape {
        /// Which part of the record.
        what: String,
        /// Entries it has.
        found: usize,
        /// Entries it needs.
        expected: usize,
        /// What each entry belongs to.
        unit: &'static str,
    },
    /// A record holds a number that JSON cannot hold and a picture cannot show.
    #[error(
        "{what} is {value}, not a finite number; look for a failed embedding and run the experiment again"
    )]
    NotFinite {
        /// Which number of the record.
        what: String,
        /// The number.
        value: f64,
    },
    /// A figure was asked for without anything to draw.
    #[error("{figure} has nothing to draw: give it at least one {unit}")]
    Empty {
        /// Which figure.
        figure: &'static str,
        /// What it draws.
        unit: &'static str,
    },
}
