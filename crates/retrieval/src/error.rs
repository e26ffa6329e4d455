//! What cannot be scored.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RetrievalError {
    /// One label per row of the matrix.
    #[error("{n_labels} labels for a matrix of {n_points} shapes; give one label per shape")]
    LabelCount {
        /// Labels given.
        n_labels: usize,
        /// Rows of the matrix.
        n_points: usize,
    },
    /// No class with more than two members.
    #[error(
        "nothing to score: no class has more than 2 shapes ({n_points} shapes in {n_classes} classes); \
         check the labels or give them with --labels FILE.csv"
    )]
    NothingToScore {
        /// Number of shapes.
        n_points: usize,
        /// Number of classes.
        n_classes: usize,
    },
    /// A vote of nobody.
    #[error("k-NN needs at least 1 neighbour and has {available} others to ask, got k = {k}")]
    BadNeighborCount {
        /// The k asked for.
        k: usize,
        /// Number of other shapes.
        available: usize,
    },
    /// A distance is not a number.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
}
