//! What methods and coarser forms give.

use linalg::{DistanceMatrix, LandmarkDistances};
use nmds::{Embedding, SamplesReport, SmacofReport};

/// The result of a method.
pub(super) struct Outcome {
    pub(super) embedding: Embedding,
    /// Distances from the samples to all vertices; from as many of them for a method without samples.
    pub(super) distances: LandmarkDistances,
    /// How the number of samples was found, if it was not given.
    pub(super) search: Option<SamplesReport>,
    /// Distances between all vertices, if the method has measured them.
    pub(super) all: Option<DistanceMatrix>,
    pub(super) descent: Option<SmacofReport>,
}
