//! Why there is no map.

use descriptors::DescriptorError;

/// Why two landmarks cannot both be right.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LandmarkConflict {
    /// They give one vertex two partners.
    #[error("they give one vertex two partners")]
    SharedVertex,
    /// Their distances on both surfaces, as shares of the diameter.
    #[error(
        "they are {:.0} % of the diameter apart on the first surface, and {:.0} % on the second",
        100.0 * .0[0], 100.0 * .0[1]
    )]
    Distance([f64; 2]),
    /// One fits the direct map only, the other the mirrored one only.
    #[error("one keeps left and right, the other exchanges them")]
    Orientation,
}

/// Errors of maps.
#[derive(Debug, thiserror::Error)]
pub enum MapError {
    /// Matrices and descriptors.
    #[error(transparent)]
    Descriptor(#[from] DescriptorError),
    /// Landmarks that contradict each other.
    #[error("the landmarks {} and {} contradict each other: {how}", landmarks[0], landmarks[1])]
    Contradiction {
        /// Positions in [`KnownMap::landmarks`](super::KnownMap::landmarks).
        landmarks: [usize; 2],
        /// Why.
        how: LandmarkConflict,
    },
}
