//! What can go wrong when distances are asked for.

use surface::VertexId;

use crate::SurfacePoint;

/// Errors of this crate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GeodesicError {
    /// The surface falls into pieces.
    #[error(
        "mesh is disconnected: {unreached} of {n_vertices} vertices not reached from vertex {source_vertex}; \
         keep the largest component or pass --components bridge"
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
        /// The vertex asked for.
        vertex: VertexId,
        /// Number of vertices.
        n_vertices: usize,
    },
    /// A source that is not on the surface.
    #[error("no such point on the surface: {reason}")]
    BadPoint {
        /// What is wrong with it.
        reason: String,
    },
    /// A path to where no distance is known.
    #[error(
        "no way is known from a source to {point}: it lies on another component or beyond the limit of the \
         distances; choose another target or raise --max-distance"
    )]
    NoWay {
        /// The end of the path.
        point: SurfacePoint,
    },
    /// A sampling without samples.
    #[error("at least 1 sample is needed, got 0")]
    NoSamples,
    /// A heat time without meaning.
    #[error(
        "the heat time {time} (in squared mean edge lengths) is not positive and finite; the usual \
         time is 0.85"
    )]
    BadHeatTime {
        /// The time asked for.
        time: f64,
    },
    /// The matrices of the heat method have no factors.
    #[error("the heat method cannot be set up: {reason}; take --method fast-marching")]
    NotFactorised {
        /// What was in the way.
        reason: String,
    },
}
