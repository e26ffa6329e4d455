//! The trait of all samplings.

use linalg::{ColumnStore, LandmarkDistances};
use surface::VertexId;

use crate::error::GeodesicError;

/// Takes landmarks on one surface, one after the other: the first n of 2n landmarks are the n landmarks.
pub trait Sampler: std::fmt::Debug {
    /// Takes further landmarks until there are `n`, or as many as the surface has.
    ///
    /// # Errors
    /// [`GeodesicError::Disconnected`] if a vertex cannot be reached.
    fn extend_to(&mut self, n: usize) -> Result<(), GeodesicError>;

    /// The distances from the first `n` landmarks, or all if there are fewer, to all vertices, in mesh units.
    ///
    /// # Errors
    /// [`GeodesicError::NoSamples`] if `n` is zero.
    fn distances(&self, n: usize) -> Result<LandmarkDistances, GeodesicError>;

    /// The same as [`distances`](Self::distances), without a copy of what is in memory.
    ///
    /// # Errors
    /// As [`distances`](Self::distances).
    fn into_distances(self: Box<Self>, n: usize) -> Result<LandmarkDistances, GeodesicError>;

    /// Moves the distances into another, empty store, where further ones go too: by default they are in memory. The
    /// result does not depend on the store.
    ///
    /// # Errors
    /// [`GeodesicError::Matrix`] if the store is a file that cannot be written.
    fn move_to(&mut self, store: ColumnStore) -> Result<(), GeodesicError>;
}

/// The first landmark.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum FirstSample {
    /// The vertex farthest from vertex 0, a tip of the surface, for
    /// [`FarthestPointSampler`](crate::FarthestPointSampler); a random one for the other samplers.
    #[default]
    Farthest,
    /// This vertex.
    Vertex(VertexId),
}
