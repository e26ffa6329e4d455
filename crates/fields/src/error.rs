//! Errors of this crate.

use std::path::PathBuf;

use base::Exceeded;
use base::files::FileError;
use geodesics::GeodesicError;
use linalg::LinalgError;
use nmds::NmdsError;

/// A field that cannot be built, read or asked.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FieldError {
    /// A file that cannot be read or written.
    #[error(transparent)]
    File(#[from] FileError),
    /// A file that is no distance field, or a damaged one.
    #[error("{path}: {fault}", path = path.display())]
    BadField {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        fault: FieldFault,
    },
    /// Distances on the surface, or a vertex that does not exist.
    #[error(transparent)]
    Geodesic(#[from] GeodesicError),
    /// Matrices.
    #[error(transparent)]
    Linalg(#[from] LinalgError),
    /// The estimates between landmarks.
    #[error(transparent)]
    Nmds(#[from] NmdsError),
    /// A limit on time or memory, or a cancellation.
    #[error(transparent)]
    Exceeded(#[from] Exceeded),
}

/// Why a file is not a distance field that this version can read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum FieldFault {
    /// It begins like no distance field.
    #[error("this is not a distance field")]
    NotAField,
    /// Another version of the program wrote it.
    #[error("the distance field has format {found}, but this version reads format {known}")]
    OtherVersion {
        /// The format of the file.
        found: u32,
        /// The format that this version reads.
        known: u32,
    },
    /// Its content does not match its checksum, or contradicts itself.
    #[error("the distance field is damaged: {0}")]
    Damaged(&'static str),
}
