//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod cholesky;
mod column_store;
mod decomposition;
mod distance_matrix;
mod generalized;
mod landmark_distances;
mod largest;
mod sparse;
