//! Errors of dataset generation.

/// Why a dataset could not be generated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// Fewer vertices than a recognisable body needs.
    #[error("{n_vertices} vertices are too few for an articulated shape; use at least {least}")]
    TooFewVertices {
        /// Requested number of vertices.
        n_vertices: usize,
        /// Smallest number.
        least: usize,
    },
    /// More vertices than the generator supports.
    #[error("{n_vertices} vertices are too many for an articulated shape; use at most {most}")]
    TooManyVertices {
        /// Requested number of vertices.
        n_vertices: usize,
        /// Largest number.
        most: usize,
    },
    /// No attempt gave a topological sphere with the requested number of vertices.
    #[error(
        "found no closed surface with {n_vertices} vertices for {shape} with seed {seed}; \
         try another seed or another number of vertices"
    )]
    NoSurface {
        /// Name of the shape.
        shape: String,
        /// Requested number of vertices.
        n_vertices: usize,
        /// The seed.
        seed: u64,
    },
}
