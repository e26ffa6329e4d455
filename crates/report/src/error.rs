//! Errors of reading records and of drawing and writing figures.

use std::path::PathBuf;

/// Errors of reading records and of drawing and writing figures.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be read or written. A file that was not written completely does not remain.
    #[error(transparent)]
    File(#[from] base::files::FileError),
    /// The time is over.
    #[error(transparent)]
    Exceeded(#[from] base::Exceeded),
    /// The drawing backend failed.
    #[error("cannot draw {figure}: {reason}; this is a bug, please report it")]
    Draw {
        /// What was drawn.
        figure: String,
        /// The message of the backend.
        reason: String,
    },
    /// A file does not hold the expected record.
    #[error("{}: not a record that this version reads: {source}; run the experiment again", path.display())]
    Parse {
        /// The file.
        path: PathBuf,
        /// Where and why parsing stopped.
        source: serde_json::Error,
    },
}

impl ReportError {
    /// The backend failed to draw `figure` for `reason`.
    pub fn draw(figure: impl ToString, reason: impl ToString) -> Self {
        Self::Draw { figure: figure.to_string(), reason: reason.to_string() }
    }
}
