//! The trait of all samplings.

use linalg::LandmarkDistances;
use surface::VertexId;

use crate::error::GeodesicError;

/// Takes landmarks on one surface, in an order that does not depend on their final number: the first n of 2n
/// landmarks are the n landmarks.
pub trait Sampler: std::fmt::Debug {
    /// Goes on until there are `n` landmarks, or as many as the surface has.
    ///
    /// # Errors
    /// [`GeodesicError::Disconnected`] if a vertex cannot be reached.
    fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError>;

    /// The distances from the first `n` landmarks to all vertices, in mesh units; from all landmarks if there are
    /// fewer.
    ///
    /// # Errors
    /// [`GeodesicError::NoSamples`] if `n` is zero.
    fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError>;
}

/// The first landmark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstSample {
    /// Left to the sampling: the vertex farthest from vertex 0 (a tip of the surface, the same in every run) for
    /// [`FarthestPointSampler`](crate::FarthestPointSampler), a random one for the others.
    #[default]
    Farthest,
    /// This vertex.
    Vertex(VertexId),
}
