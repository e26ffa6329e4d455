//! Errors.

use surface::{SurfacePoint, VertexId};

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GeodesicError {
    /// The surface has several components.
    #[error(
        "the mesh is disconnected: {unreached} of {n_vertices} vertices cannot be reached from vertex {source_vertex}"
    )]
    Disconnected {
        /// Number of vertices without a finite distance.
        unreached: usize,
        /// Number of vertices.
        n_vertices: usize,
        /// The source.
        source_vertex: VertexId,
    },
    /// A source or first sample that does not exist.
    #[error("vertex {vertex} does not exist; the mesh has {n_vertices} vertices, counted from 0")]
    NoSuchVertex {
        /// The vertex.
        vertex: VertexId,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A source that is not on the surface, and why.
    #[error("no such point on the surface: {0}")]
    BadPoint(String),
    /// A path to a point without a distance.
    #[error(
        "no path to {point}: it is on another component or beyond the distance limit; choose another target or raise \
         the limit"
    )]
    NoPath {
        /// The end of the path.
        point: SurfacePoint,
    },
    /// A sampling without samples.
    #[error("at least 1 sample is needed, got 0")]
    NoSamples,
    /// A heat time that is not positive and finite.
    #[error("heat time {time} is not positive and finite; the default is 0.85, in squared mean edge lengths")]
    BadHeatTime {
        /// The time.
        time: f64,
    },
    /// The matrices of the heat method cannot be factorized.
    #[error("cannot set up the heat method: {0}; use fast marching")]
    NotFactorized(linalg::LinalgError),
    /// A limit on time or memory, or a cancellation.
    #[error(transparent)]
    Exceeded(#[from] base::Exceeded),
    /// Distances that are no matrix, because a vertex cannot be reached from another.
    #[error(transparent)]
    Matrix(linalg::LinalgError),
}

impl From<linalg::LinalgError> for GeodesicError {
    fn from(error: linalg::LinalgError) -> Self {
        match error {
            linalg::LinalgError::Exceeded(exceeded) => Self::Exceeded(exceeded),
            other => Self::Matrix(other),
        }
    }
}
