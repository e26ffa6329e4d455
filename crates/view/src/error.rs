//! Errors of drawing and writing images.

/// Errors of drawing and writing images.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// A file could not be written. No part of it remains.
    #[error(transparent)]
    File(#[from] files::FileError),
    /// The drawing backend failed.
    #[error("cannot draw {figure}: {reason}; this is a bug, please report it")]
    Draw {
        /// What was drawn.
        figure: String,
        /// The message of the backend.
        reason: String,
    },
}

impl ViewError {
    /// The backend failed to draw `figure` for `reason`.
    pub fn draw(figure: impl ToString, reason: impl ToString) -> Self {
        Self::Draw { figure: figure.to_string(), reason: reason.to_string() }
    }
}
