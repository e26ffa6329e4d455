//! Errors of this crate.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DescriptorError {
    /// An embedding in another number of dimensions.
    #[error("a canonical form has 3 dimensions, the embedding has {dim}")]
    NotThreeDimensional {
        /// Dimensions of the embedding.
        dim: usize,
    },
    /// An embedding of another mesh.
    #[error("the embedding has {n_points} points but the mesh has {n_vertices} vertices")]
    SizeMismatch {
        /// Points of the embedding.
        n_points: usize,
        /// Vertices of the mesh.
        n_vertices: usize,
    },
    /// All points coincide, or a coordinate is not a number.
    #[error("the form has no extent: all {n_points} points coincide or are not finite")]
    NoExtent {
        /// Number of points.
        n_points: usize,
    },
    /// A single triangle, which differs from others in its proportions only.
    #[error("the mesh is a single triangle, which is no shape to compare; leave it out")]
    OneTriangle,
    /// Signatures with values that are not finite.
    #[error(
        "the signatures of the mesh are not finite: its triangles differ too much in size; remesh it, or remove vertices \
         that lie far from the rest"
    )]
    NotFinite,
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
    /// Distances were not embedded.
    #[error(transparent)]
    Nmds(#[from] nmds::NmdsError),
}

impl From<rigid::NoExtent> for DescriptorError {
    fn from(rigid::NoExtent { n_points }: rigid::NoExtent) -> Self {
        Self::NoExtent { n_points }
    }
}
