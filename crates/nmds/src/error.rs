//! What an embedding cannot be made from.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NmdsError {
    /// More eigenpairs asked for than there are samples, or none.
    #[error("rank {rank} is impossible with {n_landmarks} samples; choose 1 to {n_landmarks}")]
    BadRank {
        /// The rank asked for.
        rank: usize,
        /// Number of samples.
        n_landmarks: usize,
    },
    /// An embedding in no dimension, or in more than the rank allows.
    #[error("cannot embed in {dim} dimensions; choose 1 to {limit}, which grows with the number of samples")]
    BadDimension {
        /// The dimension asked for.
        dim: usize,
        /// The largest possible.
        limit: usize,
    },
    /// All distances are zero.
    #[error("all distances are zero: {n_points} points coincide and have no shape")]
    NoExtent {
        /// Number of points.
        n_points: usize,
    },
    /// A kernel width that is not a positive number.
    #[error("kernel width {sigma} must be a positive number, in the unit of the distances")]
    BadBandwidth {
        /// The width given.
        sigma: f64,
    },
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
}
