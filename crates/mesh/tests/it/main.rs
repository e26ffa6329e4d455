//! Laws of repair.

// Helper functions are test code too, which clippy cannot see.
#![allow(clippy::unwrap_used)]

mod hubs;
mod repair;
mod t_junctions;
