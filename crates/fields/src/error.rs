//! Errors of this crate.

use std::path::PathBuf;

use base::Exceeded;
use base::files::FileError;
use geodesics::GeodesicError;
use linalg::LinalgError;
use nmds::NmdsError;

use crate::fault::FieldFault;

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
