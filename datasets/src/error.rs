//! What can go wrong.

/// Why no dataset came out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DatasetError {
    /// Fewer vertices than a recognisable body needs.
    #[error("{n_vertices} vertices are too few for an articulated shape: ask for at least {least}")]
    TooFewVertices {
        /// Vertices asked for.
        n_vertices: usize,
        /// Smallest number possible.
        least: usize,
    },
    /// More vertices than are offered.
    #[error("{n_vertices} vertices are too many for an articulated shape: ask for at most {most}")]
    TooManyVertices {
        /// Vertices asked for.
        n_vertices: usize,
        /// Largest number possible.
        most: usize,
    },
    /// No attempt gave a closed surface without handles and with the wanted number of vertices.
    #[error(
        "no closed surface with {n_vertices} vertices for {shape} under seed {seed}: \\
         try another seed or another number of vertices"
    )]
    NoSurface {
        /// Name of the shape.
        shape: String,
        /// Vertices asked for.
        n_vertices: usize,
        /// Seed asked for.
        seed: u64,
    },
}
