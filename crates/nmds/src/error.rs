//! Errors of this crate.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NmdsError {
    /// The rank is zero or exceeds the number of samples.
    #[error("rank {rank} is impossible with {n_landmarks} samples; choose 1 to {n_landmarks}")]
    BadRank {
        /// The requested rank.
        rank: usize,
        /// Number of samples.
        n_landmarks: usize,
    },
    /// The dimension is zero or larger than the rank allows.
    #[error("cannot embed in {dim} dimensions; choose 1 to {limit} (more samples allow more)")]
    BadDimension {
        /// The requested dimension.
        dim: usize,
        /// The largest possible dimension.
        limit: usize,
    },
    /// The regularization parameter is not a positive number.
    #[error("the c of alpha = c sigma1^4 must be a positive number, not {0}; 1e-10 is a good choice")]
    BadAlpha(f64),
    /// Two arguments have different numbers of points.
    #[error("{given} points were given, but the distances are between {n_points}")]
    PointMismatch {
        /// Number of points given.
        given: usize,
        /// Number of points of the distances.
        n_points: usize,
    },
    /// The convergence tolerance is negative or not a number.
    #[error("the tolerance must be a number of at least 0, not {0}; 1e-6 is a good choice")]
    BadTolerance(f64),
    /// All distances between this number of points are zero.
    #[error("all distances are zero: {0} points coincide and have no shape")]
    NoExtent(usize),
    /// The kernel width is not a positive number.
    #[error("the kernel width must be a positive number in the unit of the distances, not {0}")]
    BadBandwidth(f64),
    /// The weight of the known distances is not positive.
    #[error("the weight mu of known distances must be positive (it may be infinite), not {0}")]
    BadSmoothness(f64),
    /// This number of samples does not determine a function on part of the surface.
    #[error(
        "{0} samples do not determine a function on the surface; take a sample in each of its components, \
         or keep the largest component only"
    )]
    NotDetermined(usize),
    /// A limit on time or memory, or a cancellation.
    #[error(transparent)]
    Exceeded(#[from] base::Exceeded),
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
}
