//! What can be wrong with distances, and what a decomposition can fail at.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LinalgError {
    /// A distance is NaN, infinite or negative.
    #[error(
        "the distance between points {row} and {column} is {value}; distances are finite and not negative \
         (unreached points must be left out before a matrix is made)"
    )]
    BadDistance {
        /// Row of the offending entry.
        row: usize,
        /// Column of the offending entry.
        column: usize,
        /// Its value.
        value: f64,
    },
    /// The number of values does not fit the shape.
    #[error("expected {expected} values for a {n_rows} x {n_columns} matrix, got {actual}")]
    Shape {
        /// Rows of the wanted matrix.
        n_rows: usize,
        /// Columns of the wanted matrix.
        n_columns: usize,
        /// Their product.
        expected: usize,
        /// Number of values given.
        actual: usize,
    },
    /// A landmark names a point that does not exist, or one twice.
    #[error("landmark {landmark} is out of range or given twice; there are {n_points} points")]
    BadLandmark {
        /// The landmark's point.
        landmark: usize,
        /// Number of points.
        n_points: usize,
    },
    /// An iterative decomposition ran out of iterations.
    #[error("the eigenvalue decomposition of a {n} x {n} matrix did not converge; check its entries for NaN")]
    NotConverged {
        /// Order of the matrix.
        n: usize,
    },
    /// Eigenvalues that were counted could not be found.
    #[error(
        "{missing} of the eigenvalues of a sparse {n} x {n} matrix below number {found} were not found; they are \
         multiple or the matrix is ill-conditioned: remove degenerate elements or ask for fewer"
    )]
    MissedEigenvalues {
        /// Order of the matrix.
        n: usize,
        /// How many are missing.
        missing: usize,
        /// How many were found in their place.
        found: usize,
    },
    /// A sparse matrix has no Cholesky factor, or none that fits.
    #[error(
        "the sparse {n} x {n} matrix cannot be factorised: {reason}; add a larger share of a positive \
         diagonal to it"
    )]
    NotFactorised {
        /// Order of the matrix.
        n: usize,
        /// What was in the way.
        reason: String,
    },
}
