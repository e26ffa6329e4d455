//! Laws of the crate, through what it exports.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod boundary;
mod bridge;
mod holes;
mod hubs;
mod locate;
mod noise;
mod orientation;
mod points;
mod refine;
mod regions;
mod repair;
mod shortcuts;
mod t_junctions;
mod validate;
