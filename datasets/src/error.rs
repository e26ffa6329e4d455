//! Errors of dataset generation.

/// Why a dataset could not be generated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// Too few vertices for a recognizable body, or more than the generator supports.
    #[error("{n_vertices} vertices are out of range for an articulated shape; use {least} to {most}")]
    VertexCount {
        /// Requested number of vertices.
        n_vertices: usize,
        /// Smallest number.
        least: usize,
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
    /// A limit was exceeded, or the work was cancelled.
    #[error(transparent)]
    Exceeded(#[from] base::Exceeded),
}
