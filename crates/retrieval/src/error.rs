//! Errors of this crate.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RetrievalError {
    /// The number of labels differs from the number of shapes.
    #[error("{n_labels} labels for {n_points} shapes; give one label per shape")]
    LabelCount {
        /// Number of labels.
        n_labels: usize,
        /// Number of shapes.
        n_points: usize,
    },
    /// No class has more than two members.
    #[error(
        "nothing to score: of {n_points} shapes, no 3 are of one class, which at least one class needs (classes: {n_classes}); \
         check the labels"
    )]
    NothingToScore {
        /// Number of shapes.
        n_points: usize,
        /// Number of classes.
        n_classes: usize,
    },
    /// A k-nearest-neighbor vote without neighbors.
    #[error("k-NN needs k of at least 1 and at least 1 other shape; k is {k}, other shapes: {available}")]
    BadNeighborCount {
        /// The requested k.
        k: usize,
        /// Number of other shapes.
        available: usize,
    },
    /// A distance is NaN, infinite or negative.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
}
