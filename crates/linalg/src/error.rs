//! Errors of this crate.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinalgError {
    /// A distance is NaN, infinite or negative.
    #[error(
        "the distance between points {row} and {column} is {value}; distances must be finite and not negative \
         (leave out unreachable points)"
    )]
    BadDistance {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Its value.
        value: f64,
    },
    /// The number of values does not match the shape.
    #[error("expected {} values for a {n_rows} x {n_columns} matrix, got {actual}", n_rows * n_columns)]
    Shape {
        /// Rows of the matrix.
        n_rows: usize,
        /// Columns of the matrix.
        n_columns: usize,
        /// Number of values given.
        actual: usize,
    },
    /// A landmark is not a point, or is given twice.
    #[error("landmark {landmark} is out of range or given twice; there are {n_points} points")]
    BadLandmark {
        /// The landmark's point.
        landmark: usize,
        /// Number of points.
        n_points: usize,
    },
    /// The iterative decomposition of a matrix of this order did not converge.
    #[error("the eigenvalue decomposition of a {0} x {0} matrix did not converge; check its entries for NaN")]
    NotConverged(usize),
    /// A sparse matrix has no Cholesky factor, or the factor does not fit into memory.
    #[error(
        "the sparse {n} x {n} matrix cannot be factorized: {reason}; add a larger multiple of a positive diagonal to \
         it"
    )]
    NotFactorized {
        /// Order of the matrix.
        n: usize,
        /// The reason.
        reason: NoFactor,
    },
    /// A temporary file that holds numbers cannot be read or written.
    #[error("a temporary file of distances cannot be used: {reason}")]
    File {
        /// The reason, in the words of the operating system.
        reason: String,
    },
    /// A limit on time or memory, or a cancellation.
    #[error(transparent)]
    Exceeded(#[from] base::Exceeded),
}

/// Why a sparse matrix has no Cholesky factor.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NoFactor {
    /// The order of elimination belongs to a matrix with other entries.
    #[error("its pattern is not the one analyzed")]
    OtherPattern,
    /// An entry is NaN or infinite.
    #[error("its entry ({row}, {column}) is {value}")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// Its value.
        value: f64,
    },
    /// A pivot is not positive.
    #[error("it is not positive definite (at column {column} in the order of elimination)")]
    NotPositiveDefinite {
        /// The column of the pivot.
        column: usize,
    },
    /// The factor, or the work on it, does not fit into memory or into its indices.
    #[error("its factor does not fit into memory")]
    OutOfMemory,
}

impl LinalgError {
    /// An error of a file that holds numbers.
    pub(crate) fn file(error: std::io::Error) -> Self {
        Self::File { reason: error.to_string() }
    }
}
