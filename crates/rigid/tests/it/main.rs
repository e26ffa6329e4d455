//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod align_points;
mod align_surfaces;
mod farthest_points;
mod similarity;
mod triangles;
