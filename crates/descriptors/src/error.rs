//! What a form cannot be made from.

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DescriptorError {
    /// A form lives in three dimensions.
    #[error("a canonical form has 3 dimensions, the embedding has {dim}; embed with --dim 3")]
    NotThreeDimensional {
        /// Dimensions of the embedding.
        dim: usize,
    },
    /// The embedding was made from another mesh.
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
    /// An option out of its range.
    #[error("{option} is {value}; it must be {range}")]
    BadOption {
        /// Name of the option.
        option: &'static str,
        /// The value given.
        value: f64,
        /// What is allowed.
        range: &'static str,
    },
    /// A signature that does not exist.
    #[error(
        "there is no signature `{name}`; choose from moments, d2, geodesic-spectrum, shape-dna, heat-kernel, \
         wave-kernel"
    )]
    UnknownSignature {
        /// The name given.
        name: String,
    },
    /// A decomposition failed.
    #[error(transparent)]
    Linalg(#[from] linalg::LinalgError),
}
