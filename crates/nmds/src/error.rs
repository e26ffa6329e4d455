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
    /// A regularisation parameter that is not a positive number.
    #[error("the regularisation alpha = {alpha} sigma1^4 needs a positive number; 1e-10 is a good one")]
    BadAlpha {
        /// The number given.
        alpha: f64,
    },
    /// Distances, or a start, of another number of points.
    #[error("{given} points were given where the distances are of {n_points}")]
    PointMismatch {
        /// Points given.
        given: usize,
        /// Points of the distances.
        n_points: usize,
    },
    /// A convergence tolerance without meaning.
    #[error("the tolerance {tolerance} must be a number from 0 on; 1e-6 stops in time")]
    BadTolerance {
        /// The tolerance given.
        tolerance: f64,
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
    /// A weight of distances that is not a positive number.
    #[error("the weight mu = {mu} of known distances must be positive; it may be infinite")]
    BadSmoothness {
        /// The weight given.
        mu: f64,
    },
    /// The samples say nothing of a part of the surface.
    #[error(
        "{n_landmarks} samples do not determine a function on the surface; take one in each of its components, or \
         keep its largest one only"
    )]
    NotDetermined {
        /// Number of samples.
        n_landmarks: usize,
    },
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
}
