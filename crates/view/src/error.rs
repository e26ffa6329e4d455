//! What can go wrong while a picture is drawn or written.

/// Errors of drawing and writing pictures.
#[derive(Debug, thiserror::Error)]
pub enum ViewError {
    /// A file could not be written; nothing of it is left behind.
    #[error(transparent)]
    File(#[from] files::FileError),
    /// The drawing backend failed.
    #[error("{figure} could not be drawn: {reason}; this is a fault of the program, please report it")]
    Draw {
        /// Which figure.
        figure: String,
        /// What the backend said.
        reason: String,
    },
}
